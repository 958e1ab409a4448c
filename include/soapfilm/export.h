/* What a shared library shows: the declarations of these headers and nothing else. */
#ifndef SOAPFILM_EXPORT_H
#define SOAPFILM_EXPORT_H

#if defined(__GNUC__)
#define SOAPFILM_API __attribute__((visibility("default")))
#else
#define SOAPFILM_API
#endif

#endif
