#pragma once

#include <string>

#include "wavefront/kernel_api.h"

namespace castray {

/// The kernels of instruction set `name`; "auto": of the best one that this processor has. Throws InputError
/// if they are not compiled, or the processor does not have it.
const KernelApi& choose_kernel(const std::string& name);

}  // namespace castray
