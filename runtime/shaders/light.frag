// Irradiance of what is seen: E_c = Σ_i k_i T_ci(n) (+ mean_c(n) for PCA), k the coefficients at the point (SH
// of visibility, or PCA weights), T the table at the shading normal. [IwanickiSloan2012, Sec. 3]
layout(binding = 0) uniform sampler2D places;
layout(binding = 1) uniform sampler2D normals;
layout(binding = 2) uniform sampler2D albedos;
layout(binding = 3) uniform usampler2D triangles;
layout(binding = 4) uniform sampler2DArray coefficients;  // [layers], four coefficients each
layout(binding = 5) uniform sampler2DArray table;         // [(3·layers (+ 1)) × 6 faces], with a border of 1
layout(binding = 6) uniform usamplerBuffer indices;

uniform int layers;
uniform int tableSize;  // texels along an edge of a face, without the border
uniform ivec2 gridSize;

layout(location = 0) out vec4 outRadiance;
layout(location = 1) out vec4 outIrradiance;

/// Image point in [0, 1]² of a point in [-1, 1]² of a face, which lies within a border of one texel.
vec2 borderedPoint(vec2 facePoint) {
    return ((facePoint * 0.5 + 0.5) * float(tableSize) + 1.0) / float(tableSize + 2);
}

#ifdef PER_VERTEX
struct Points {
    ivec2 corner[3];
    vec3 weights;
};

ivec2 gridPoint(uint index) {
    const int vertex = int(texelFetch(indices, int(index)).r);
    return ivec2(vertex % gridSize.x, vertex / gridSize.x);
}

Points pointsAt(ivec2 pixel, vec4 place) {
    const uint first = texelFetch(triangles, pixel, 0).r * 3u;
    // Pixels whose centre lies a little outside of the triangle must not extrapolate.
    const vec3 b = max(vec3(1.0 - place.x - place.y, place.xy), 0.0);
    return Points(ivec2[3](gridPoint(first), gridPoint(first + 1u), gridPoint(first + 2u)), b / (b.x + b.y + b.z));
}

vec4 coefficientsAt(Points points, int layer) {
    return points.weights.x * texelFetch(coefficients, ivec3(points.corner[0], layer), 0) +
           points.weights.y * texelFetch(coefficients, ivec3(points.corner[1], layer), 0) +
           points.weights.z * texelFetch(coefficients, ivec3(points.corner[2], layer), 0);
}
#else
#define Points vec2

Points pointsAt(ivec2 pixel, vec4 place) { return place.zw; }

vec4 coefficientsAt(Points point, int layer) { return textureLod(coefficients, vec3(point, layer), 0.0); }
#endif

void main() {
    const ivec2 pixel = ivec2(gl_FragCoord.xy);
    const Points points = pointsAt(pixel, texelFetch(places, pixel, 0));
    vec2 facePoint;
    const int face = cubeFace(texelFetch(normals, pixel, 0).xyz, facePoint);
    const vec2 normal = borderedPoint(facePoint);
    vec3 irradiance = vec3(0.0);
#ifdef WITH_MEAN
    irradiance = textureLod(table, vec3(normal, 18 * layers + face), 0.0).rgb;
#endif
    for (int i = 0; i < layers; ++i) {
        const vec4 k = coefficientsAt(points, i);
        irradiance += vec3(dot(k, textureLod(table, vec3(normal, 6 * i + face), 0.0)),
                           dot(k, textureLod(table, vec3(normal, 6 * (layers + i) + face), 0.0)),
                           dot(k, textureLod(table, vec3(normal, 6 * (2 * layers + i) + face), 0.0)));
    }
    // Measured as it is; shown without the negative lobes that truncation leaves in the dark.
    outIrradiance = vec4(irradiance, 1.0);
    outRadiance = vec4(texelFetch(albedos, pixel, 0).rgb / kPi * irradiance, 1.0);
}
