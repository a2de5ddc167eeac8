#pragma once

namespace castray {

/// The instruction sets that kernels are compiled for.
enum class InstructionSet { scalar, sse4, avx2, avx512 };

/// Whether this processor has all that kernels for `set` use. To be asked before any of their code runs.
bool processor_has(InstructionSet set);

}  // namespace castray
