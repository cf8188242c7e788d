// The environment behind the scene, orientation as in math/environment.h, bilinear.
layout(binding = 8) uniform sampler2D environment;

uniform vec3 rayCorner, rayPerPixelX, rayPerPixelY;  // direction = corner + x·X + y·Y, in pixels from the top left
uniform float rotationRad;

/// @param place  in the image, pixels from the top left corner
vec3 environmentAt(vec2 place) {
    const vec3 d = normalize(rayCorner + place.x * rayPerPixelX + place.y * rayPerPixelY);
    const ivec2 size = textureSize(environment, 0);
    const float longitude = atan(d.x, d.z) - rotationRad;
    const float latitude = atan(d.y, length(d.xz));  // asin is good to three digits only in Mesa
    const vec2 point = vec2(0.5 - longitude / (2.0 * kPi), 0.5 - latitude / kPi) * vec2(size) - 0.5;
    const vec2 base = floor(point), f = point - base;
    const int y0 = clamp(int(base.y), 0, size.y - 1), y1 = clamp(int(base.y) + 1, 0, size.y - 1);
    const int x0 = int(mod(base.x, float(size.x))), x1 = (x0 + 1) % size.x;
    const vec3 top = mix(texelFetch(environment, ivec2(x0, y0), 0).rgb,
                         texelFetch(environment, ivec2(x1, y0), 0).rgb, f.x);
    const vec3 bottom = mix(texelFetch(environment, ivec2(x0, y1), 0).rgb,
                            texelFetch(environment, ivec2(x1, y1), 0).rgb, f.x);
    return mix(top, bottom, f.y);
}
