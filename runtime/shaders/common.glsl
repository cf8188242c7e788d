// Shared by all shaders. Images have their top row first (glClipControl with GL_UPPER_LEFT).

const float kPi = 3.14159265358979;

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
