/*
 * SHA-256 (FIPS 180-4), to identify a scene file; `sha256sum` prints the same.
 */
#ifndef ASDIC_BASE_SHA256_H
#define ASDIC_BASE_SHA256_H

#include <stddef.h>

/* 64 hexadecimal digits and a zero byte. */
void asdic_sha256_hex(const void *data, size_t bytes, char hex[65]);

#endif
