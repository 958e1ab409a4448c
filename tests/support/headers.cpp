// Empty: the translation unit for the precompiled headers of all tests.
