// Nothing: the translation unit that the precompiled headers of all tests come with.
