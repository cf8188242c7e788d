// Pulls each corner of each triangle from buffers, so that triangle and corner are known to the fragment.
layout(binding = 0) uniform usamplerBuffer indices;
layout(binding = 1) uniform samplerBuffer positions;
layout(binding = 2) uniform samplerBuffer normals;
layout(binding = 3) uniform samplerBuffer tangents;
layout(binding = 4) uniform samplerBuffer uv0s;
layout(binding = 5) uniform samplerBuffer uv1s;

uniform vec3 eye;
uniform mat4 clipFromEyeOffset;  // of world positions less the eye, which keeps digits far from the origin
uniform int hasTangents, hasUv0, hasUv1;

PLACED out vec3 normal;
PLACED out vec4 tangent;
PLACED out vec2 uv0, uv1, barycentric;
flat out uint triangle;

void main() {
    const int vertex = int(texelFetch(indices, gl_VertexID).r);
    const int corner = gl_VertexID % 3;
    triangle = uint(gl_VertexID / 3);
    barycentric = vec2(corner == 1, corner == 2);
    normal = texelFetch(normals, vertex).xyz;
    tangent = hasTangents != 0 ? texelFetch(tangents, vertex) : vec4(0.0);
    uv0 = hasUv0 != 0 ? texelFetch(uv0s, vertex).xy : vec2(0.0);
    uv1 = hasUv1 != 0 ? texelFetch(uv1s, vertex).xy : vec2(0.0);
    gl_Position = clipFromEyeOffset * vec4(texelFetch(positions, vertex).xyz - eye, 1.0);
}
