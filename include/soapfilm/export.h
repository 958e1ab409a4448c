/* What a shared library shows: the declarations of these headers and nothing else. */
#ifndef SOAPFILM_EXPORT_H
#define SOAPFILM_EXPORT_H

#ifdef __cplusplus
#define SOAPFILM_API [[gnu::visibility("default")]]
#else
#define SOAPFILM_API
#endif

#endif
