#pragma once

#include <Driver/OniDriverAPI.h>

/// ONI_EXPORT_DRIVER(Driver) is written with two macros of OpenNI2's internal library, which no package ships.
#define XN_NEW(Type, ...) new Type(__VA_ARGS__)
#define XN_DELETE(pointer) delete (pointer)
