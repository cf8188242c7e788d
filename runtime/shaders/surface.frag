// What is seen, before any light: place on the triangle, shading normal, albedo. Drawn once for each triangle of
// a pixel; of several samples to a pixel, all that are covered get it, and its place is within the triangle.
layout(binding = 6) uniform sampler2D baseColorMap;
layout(binding = 7) uniform sampler2D normalMap;

uniform vec3 baseColor;
uniform float normalScale;
uniform int useNormalMap;

PLACED in vec3 normal;
PLACED in vec4 tangent;
PLACED in vec2 uv0, uv1, barycentric;
flat in uint triangle;

layout(location = 0) out vec4 outPlace;  // barycentric coordinates of corners 1 and 2, uv1
layout(location = 1) out vec4 outNormal;
layout(location = 2) out vec4 outAlbedo;
layout(location = 3) out uint outTriangle;

void main() {
    vec3 n = normal;
    if (useNormalMap != 0) {
        // The frame is not normalised before the sum: that is how normal maps are baked (MikkTSpace).
        vec3 t = texture(normalMap, uv0).xyz * 2.0 - 1.0;
        t.xy *= normalScale;
        n = t.x * tangent.xyz + t.y * (tangent.w < 0.0 ? -1.0 : 1.0) * cross(normal, tangent.xyz) + t.z * normal;
    }
    // Opposing vertex normals may cancel in one point; any direction is better than NaN there.
    const float squared = dot(n, n);
    outNormal = vec4(squared > 1e-24 ? n * inversesqrt(squared) : vec3(0.0, 1.0, 0.0), 0.0);
    outPlace = vec4(barycentric, uv1);
    outAlbedo = vec4(baseColor * texture(baseColorMap, uv0).rgb, 1.0);
    outTriangle = triangle;
}
