#include "core/body/body.h"
#include "core/body/clip.h"

namespace frm {

// The clip is against the calm surface, not the waves: the linear theory of Eqs. 7 and 8 takes what pushes the water
// at its mean place. Against the waves, a column that the body pierces would be thicker where the water is higher and
// so raise the water again: beside a box at rest in 0.4 m of water a ripple of 1 mm then grew to 0.35 m in two
// seconds.
void lay_displacement(Body& body, float level, bool spread) {
    const Map& map = *body.def.map;
    Footprint& footprint = *body.footprint;
    for (const auto& index : map.triangles) {
        const Corner corner[3] = {{body.local[index[0]], level - body.local[index[0]].z},
                                  {body.local[index[1]], level - body.local[index[1]].z},
                                  {body.local[index[2]], level - body.local[index[2]].z}};
        if (!(corner[0].depth > 0 || corner[1].depth > 0 || corner[2].depth > 0)) continue;
        const float area_up = vector_area_of(corner[0].at, corner[1].at, corner[2].at).z;
        add_wet_part(corner, [&](const Corner& a, const Corner& b, const Corner& c, float share) {
            const Vec3f at[3] = {a.at, b.at, c.at};
            const float depth[3] = {a.depth, b.depth, c.depth};
            footprint.deposit(at, depth, share * area_up, spread);
        });
    }
    footprint.gather();
}

}  // namespace frm
