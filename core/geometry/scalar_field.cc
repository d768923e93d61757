#include "core/geometry/scalar_field.h"
