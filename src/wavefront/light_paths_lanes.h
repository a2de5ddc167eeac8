#pragma once

#include "lights/emission_guide_lanes.h"
#include "wavefront/follow_lanes.h"
#include "wavefront/scratch_lanes.h"

// Caustics: paths from a light that mirrors, glass or other surfaces that focus scatter first, and others
// later. A scattering focuses if it is that of a perfectly smooth lobe, or on a surface with trait_focuses.
// Paths from the camera find them by chance only, when a narrow lobe sends them to a light. So where the
// camera sees a scattering that does not focus this class of paths is given wholly to paths from lights,
// whose vertices after the first chain of focusing ones are each connected to the camera (Arvo 1986; Veach
// 1997, chapter 10, with one light subpath technique for the class); paths from the camera leave out what
// they find of it. Paths that begin with a focusing scattering at the camera, and light from outside the
// scene, stay with the paths from the camera.

namespace castray::CASTRAY_ISA {

/// The numbers of light paths stand in the random sequence one after the other, over all samples of a
/// replicate.
CASTRAY_INLINE uint32_t light_path_key(const Context& c, const LightPathJob& job) {
  const uint32_t key = hash_once(hash_once(c.options.seed, 0x119487u), (uint32_t)(job.first >> index_bits));
  return lane(with_epoch(Uint(key), job.sample), 0);
}

/// A direction in which a light emits, and what it carries over what it would if it were chosen by the
/// cosine.
struct Emitted {
  Vec w;
  Float weight;
};

/// By the cosine where nothing is known of the place; elsewhere most follow the guide. `choice` is used up.
CASTRAY_INLINE Emitted emit(const EmissionGuideTable& guide, const Vec& p, const Vec& normal, Float choice,
                            Float u, Float v) {
  constexpr float guided_share = 0.8f;
  const Vec by_cosine = to_world(make_frame(normal), cosine_hemisphere(u, v));
  const GuideCell cell = guide_cell(guide, p);
  if (none(cell.known)) return {by_cosine, Float(1.f)};
  const Mask guided = cell.known & (choice < Float(guided_share));
  const Vec by_guide = direction_in(guide.cumulative, cell.row, choice * Float(1.f / guided_share), u, v);
  const Vec w = select(guided, by_guide, by_cosine);
  const Float cosine = max(dot(normal, w), Float(0.f)) * Float(1.f / pi);
  const Float pdf =
      fma(Float(guided_share), pdf_of(guide.cumulative, cell.row, w), Float(1 - guided_share) * cosine);
  return {w, select(cell.known, select(cosine > Float(0.f), cosine / pdf, Float(0.f)), Float(1.f))};
}

/// Emits light paths: a light chosen by power, a point of its area, and a direction in which mirrors and
/// glass are likely to be. Their throughput is the colour of what they carry, over its greatest component,
/// which `emissions` has.
CASTRAY_STAGE inline void start_light_paths(const Context& c, const LightPathJob& job, Paths& out,
                                            Emissions& emissions) {
  LightList lights = c.scene.lights;
  lights.cut_count = 0;
  lights.regions = {};
  lights.by_solid_angle = false;
  const Vec zero = black();
  const Receiver anywhere = receiving_point(lights.regions, zero, zero, Mask(false));
  const uint32_t key = light_path_key(c, job);
  out.count = 0;
  for (int i = 0; i < job.count; i += width) {
    const Uint entry = Uint((uint32_t)i) + lane_index();
    const Uint index = Uint((uint32_t)job.first & ((1u << index_bits) - 1)) + entry;
    const Numbers<4> n = draw<4>(c.options.sobol, {Uint(key), index}, PathBlocks::camera);
    const Numbers<4> choice = draw<4>(c.options.sobol, {Uint(key), index}, PathBlocks::choice(0));
    const LightPoint point = sample_light(lights, anywhere, choice.u[0], choice.u[1], n.u[0], n.u[1]);
    const Mask back = point.two_sided & (choice.u[2] < Float(0.5f));
    const Vec normal = select(back, -point.normal, point.normal);
    const Vec emitted = point.weight * select(point.two_sided, Float(2 * pi), Float(pi));
    const Float most = max_component(emitted);
    const Emitted to = emit(c.scene.lights.emission, point.p, normal, choice.u[3], n.u[2], n.u[3]);
    const Mask shines = first_lanes(job.count - i) & (most * to.weight > Float(0.f));
    const int k = out.count;
    compress_store(out.o, k, shines, fma(normal, point.error, point.p));
    compress_store(out.d, k, shines, to.w);
    compress_store(out.throughput, k, shines, emitted * (Float(1.f) / most));
    compress_store(out.arrival + k, shines, Float(0.f));
    compress_store(out.eta2 + k, shines, Float(1.f));
    store(out.media + i, Uint(0u));
    compress_store(out.names.slot + k, shines, entry);
    compress_store(out.names.key + k, shines, Uint(key));
    compress_store(out.names.index + k, shines, index);
    compress_store(out.names.light_u + k, shines, Float(0.f));
    compress_store(out.names.light_v + k, shines, Float(0.f));
    store(emissions.p, i, point.p);
    store(emissions.flux + i, most * to.weight * Float(1.f / ((float)job.width * (float)job.height)));
    store(emissions.radiance + i, max_component(point.weight) * point.density);
    out.count += count(shines);
  }
}

/// Tells which of the light paths with these first vertices have come to a surface that focuses. `out`: room
/// for these.
CASTRAY_STAGE inline void tell_focused(const Context& c, const Vertices& vertices, const Emissions& emissions,
                                       const EmissionSink& sink, Emissions& out) {
  VecArray<capacity> w;
  int n = 0;
  for (int i = 0; i < vertices.count; i += width) {
    const Mask focused = first_lanes(vertices.count - i) & ~gathers(c.scene, records_of(vertices, i));
    const Uint slot = select(focused, load(vertices.names.slot + i), Uint(0u));
    compress_store(out.p, n, focused, gather_entries(emissions.p, slot));
    compress_store(w, n, focused, -load(vertices.wo, i));
    compress_store(out.flux + n, focused, gather(emissions.flux, slot));
    n += count(focused);
  }
  sink.add(sink.self, {n, {out.p.x, out.p.y, out.p.z}, {w.x, w.y, w.z}, out.flux});
}

/// Tells which of the light paths with these vertices have come to a surface that does not focus. `out`: room
/// for these.
CASTRAY_STAGE inline void tell_arrivals(const Context& c, const Vertices& vertices,
                                        const Emissions& emissions, const EmissionSink& sink,
                                        Emissions& out) {
  VecArray<capacity> w;
  int n = 0;
  for (int i = 0; i < vertices.count; i += width) {
    const Mask arrived = first_lanes(vertices.count - i) & gathers(c.scene, records_of(vertices, i));
    const Uint slot = select(arrived, load(vertices.names.slot + i), Uint(0u));
    const Float carried = max_component(load(vertices.throughput, i)) * load(vertices.eta2 + i);
    compress_store(out.p, n, arrived, load(vertices.p, i));
    compress_store(w, n, arrived, load(vertices.wo, i));
    compress_store(out.flux + n, arrived, gather(emissions.flux, slot) * carried);
    n += count(arrived);
  }
  sink.add(sink.self, {n, {out.p.x, out.p.y, out.p.z}, {w.x, w.y, w.z}, out.flux});
}

/// Traces light paths to their ends, and gives their splats to the sink.
template <class Geometry, uint32_t features>
CASTRAY_INLINE uint64_t trace_light_paths(const KernelScene& scene, const KernelOptions& options,
                                          const LightPathJob& job, void* scratch, const SplatSink& sink) {
  Scratch& s = *static_cast<Scratch*>(scratch);
  constexpr uint32_t last_to_arrive = 32;
  const TileJob no_tile{};
  Context c{scene, options, no_tile, s.ends, world_key(options, job.sample)};
  s.ends.fill();
  start_light_paths(c, job, s.paths, s.light_paths);
  for (uint32_t vertex = 1; s.paths.count > 0 && may_have_edges(options, vertex + 1); ++vertex) {
    closest<Geometry>(c, s.paths, false, s.hits);
    absorb<Geometry>(c, s.hits, false, s.paths);
    surfaces<Geometry, features, true>(c, s.paths, s.hits, false, s.vertices, s.radiance, true);
    if (job.emission && vertex == 1) {
      tell_focused(c, s.vertices, s.light_paths, *job.emission, s.focused);
      if (!job.arrivals) break;
    } else if (job.arrivals) {
      tell_arrivals(c, s.vertices, s.light_paths, *job.arrivals, s.focused);
      if (vertex == last_to_arrive) break;
    } else if (vertex > 1) {
      CameraConnections& to = s.to_camera;
      connect_camera<Geometry, features>(c, job, vertex, s.vertices, s.hits, s.light_paths, to);
      sink.add(sink.self, {to.rays.count,
                           to.x,
                           to.y,
                           {to.splat.x, to.splat.y, to.splat.z},
                           {to.by_chance.x, to.by_chance.y, to.by_chance.z}});
    }
    scatter<features>(c, s.vertices, vertex, first_roulette_of_suffixes, s.paths,
                      vertex == 1 || job.arrivals ? Transport::from_light_caustic : Transport::from_light);
  }
  return c.rays;
}

}  // namespace castray::CASTRAY_ISA
