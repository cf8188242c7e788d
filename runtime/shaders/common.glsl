// Shared by all shaders. Images have their top row first (glClipControl with GL_UPPER_LEFT).

const float kPi = 3.14159265358979;
const int kSamples = 4;  // of a pixel, where it has several
const uint kNoTriangle = 0xffffffffu;

// Where attributes are taken: at the pixel's centre, or, of several samples, where the triangle is.
#ifdef MULTISAMPLED
#define PLACED centroid
#else
#define PLACED
#endif

/// Face (OpenGL order) and point in [-1, 1]² that a direction falls on; the layout of math/sphere_map.h.
int cubeFace(vec3 direction, out vec2 point) {
    const vec3 size = abs(direction);
    if (size.x >= size.y && size.x >= size.z) {
        point = vec2(direction.x > 0.0 ? -direction.z : direction.z, -direction.y) / size.x;
        return direction.x > 0.0 ? 0 : 1;
    }
    if (size.y >= size.z) {
        point = vec2(direction.x, direction.y > 0.0 ? direction.z : -direction.z) / size.y;
        return direction.y > 0.0 ? 2 : 3;
    }
    point = vec2(direction.z > 0.0 ? direction.x : -direction.x, -direction.y) / size.z;
    return direction.z > 0.0 ? 4 : 5;
}

/// Point in [-1, 1]² and square (0: +Z, 1: −Z) that a direction falls on; the dual-paraboloid layout of
/// math/sphere_map.h. [IwanickiSloan2012, Appendix A], [ShirleyChiu1997]
vec3 dualParaboloidPoint(vec3 direction) {
    const vec3 unit = normalize(direction);
    const float face = unit.z >= 0.0 ? 0.0 : 1.0;
    const vec2 p = vec2(face == 0.0 ? unit.x : -unit.x, -unit.y);
    const float radius = min(length(p) / (1.0 + abs(unit.z)), 1.0);
    const bool wide = abs(p.x) >= abs(p.y);
    const float large = wide ? p.x : p.y, small = wide ? p.y : p.x;
    const float along = large < 0.0 ? -radius : radius;
    const float across = large == 0.0 ? 0.0 : along * (4.0 / kPi) * atan(small / large);
    return vec3(wide ? vec2(along, across) : vec2(across, along), face);
}

/// Point in [-1, 1]² that a direction falls on; the octahedral layout of math/sphere_map.h.
vec2 octahedralPoint(vec3 direction) {
    const vec3 size = abs(direction);
    vec2 p = size.xy / (size.x + size.y + size.z);
    if (direction.z < 0.0) p = 1.0 - p.yx;
    return vec2(direction.x < 0.0 ? -p.x : p.x, direction.y > 0.0 ? -p.y : p.y);
}
