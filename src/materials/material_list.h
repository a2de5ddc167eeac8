#pragma once

// The one list of materials: for hosts, and, where an instruction set is compiled for, for its kernels. A
// material is a host model X.h with its descriptor X.cpp, a lane model X_lanes.h, and a line in each half.

#ifdef CASTRAY_ISA

#include "materials/conductor_lanes.h"
#include "materials/dielectric_lanes.h"
#include "materials/diffuse_lanes.h"
#include "materials/microfacet_lanes.h"
#include "materials/principled_lanes.h"

namespace castray::CASTRAY_ISA {

template <class... Models>
struct ModelList {};

/// The first one is so common that kernels do not ask whether it is there.
inline constexpr ModelList<Diffuse, Conductor, Microfacet, Dielectric, Principled> all_models;

}  // namespace castray::CASTRAY_ISA

#else

#include <variant>

#include "materials/conductor.h"
#include "materials/dielectric.h"
#include "materials/diffuse.h"
#include "materials/microfacet.h"
#include "materials/principled.h"

namespace castray {

template <class T>
using AnyBsdf = std::variant<Diffuse<T>, Conductor<T>, Microfacet<T>, Dielectric<T>, Principled<T> >;

}  // namespace castray

#endif
