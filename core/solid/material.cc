#include "core/solid/material.h"
