#include "core/body/body.h"

namespace frm {

Body::Body(const BodyDef& d, std::uint32_t number, std::pmr::memory_resource* memory)
    : def(d),
      id(number),
      rotation(d.pose.rotation),
      streams(d.map->sources.size(), memory),
      sources(d.map->sources.size(), SourceState(), memory) {}

Vec3f Body::centre() const { return def.map->clusters.centre * def.scale; }

float Body::radius() const { return def.map->clusters.radius * def.scale; }

GridPlacement placement(const Body& body, const GridOrigin& origin, float cells_per_metre) {
    const float m = cells_per_metre * body.def.scale;
    const Vec3f &r0 = body.rotation.row0, &r1 = body.rotation.row1, &c = body.def.map->clusters.centre;
    return {origin.i,
            origin.j,
            origin.x + m * dot(r0, c),
            origin.y + m * dot(r1, c),
            {m * r0.x, m * r0.y, m * r0.z},
            {m * r1.x, m * r1.y, m * r1.z}};
}

void sum_forces(Body& body, const Fluid& fluid) {
    const Vec3f weight(0, 0, -body.def.mass * fluid.gravity);
    const Vec3f arm = body.rotation.to_world(body.def.centre_of_mass * body.def.scale);
    Forces& f = body.forces;
    f.gravity = {weight, cross(arm, weight)};
    f.total = {((f.buoyancy.force + f.pressure.force) + f.friction.force) + f.gravity.force,
               ((f.buoyancy.torque + f.pressure.torque) + f.friction.torque) + f.gravity.torque};
}

}  // namespace frm
