/* A shared library exports only the declarations of these headers. */
#ifndef SOAPFILM_EXPORT_H
#define SOAPFILM_EXPORT_H

#ifdef __cplusplus
#define SOAPFILM_API [[gnu::visibility("default")]]
#else
#define SOAPFILM_API
#endif

#endif
