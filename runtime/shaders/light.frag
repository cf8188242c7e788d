// Irradiance of what is seen: E_c = Σ_i k_i T_ci(n) (+ mean_c(n) for PCA), k the coefficients at the point (SH
// of visibility, or PCA weights), T the table at the shading normal. [IwanickiSloan2012, Sec. 3]
layout(binding = 0) uniform sampler2D places;
layout(binding = 1) uniform sampler2D normals;
layout(binding = 2) uniform sampler2D albedos;
layout(binding = 3) uniform usampler2D triangles;
layout(binding = 4) uniform sampler2DArray coefficients;  // [layers], four coefficients each
layout(binding = 5) uniform sampler2DArray table;         // [3·layers (+ 1)] images of the layout
layout(binding = 6) uniform usamplerBuffer indices;
layout(binding = 7) uniform sampler2DArray sunShadows;  // four suns to a layer

uniform int layers;
uniform int tableSize;  // texels along the side of a face, without a border
uniform ivec2 gridSize;
uniform int sunCount;
uniform vec3 sunDirection[8], sunIrradiance[8];

layout(location = 0) out vec4 outRadiance;
layout(location = 1) out vec4 outIrradiance;

// Images that one group of four coefficients has, and where a normal falls on: the point in [0, 1]² and which of
// these images. Layouts as in math/table_layout.h.
#if defined(TABLE_DUAL_PARABOLOID)
const int kGroupImages = 1;

vec3 tablePoint(vec3 normal) {
    const vec3 st = dualParaboloidPoint(normal);
    const float size = float(tableSize);
    const vec2 texel = 0.5 + (0.5 * st.xy + 0.5) * (size - 1.0);
    return vec3((st.z * size + texel.x) / (2.0 * size), texel.y / size, 0.0);
}
#elif defined(TABLE_OCTAHEDRAL)
const int kGroupImages = 1;

vec3 tablePoint(vec3 normal) {
    const vec2 texel = 1.0 + (0.5 * octahedralPoint(normal) + 0.5) * float(tableSize);
    return vec3(texel / float(tableSize + 2), 0.0);
}
#else
const int kGroupImages = 6;  // each within a border of one texel of its neighbours

vec3 tablePoint(vec3 normal) {
    vec2 point;
    const int face = cubeFace(normal, point);
    return vec3(((point * 0.5 + 0.5) * float(tableSize) + 1.0) / float(tableSize + 2), face);
}
#endif

vec4 tableAt(vec3 point, int group) {
    return textureLod(table, vec3(point.xy, float(kGroupImages * group) + point.z), 0.0);
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

vec4 valuesAt(sampler2DArray image, Points points, int layer) {
    return points.weights.x * texelFetch(image, ivec3(points.corner[0], layer), 0) +
           points.weights.y * texelFetch(image, ivec3(points.corner[1], layer), 0) +
           points.weights.z * texelFetch(image, ivec3(points.corner[2], layer), 0);
}
#else
#define Points vec2

Points pointsAt(ivec2 pixel, vec4 place) { return place.zw; }

vec4 valuesAt(sampler2DArray image, Points point, int layer) { return textureLod(image, vec3(point, layer), 0.0); }
#endif

/// Each sun: what it sends to a surface of this normal, times the share of its disc that the point sees.
vec3 sunlight(Points points, vec3 normal) {
    vec3 sum = vec3(0.0);
    for (int i = 0; i < sunCount; ++i)
        sum += sunIrradiance[i] * max(dot(normal, sunDirection[i]), 0.0) * valuesAt(sunShadows, points, i / 4)[i % 4];
    return sum;
}

void main() {
    const ivec2 pixel = ivec2(gl_FragCoord.xy);
    const Points points = pointsAt(pixel, texelFetch(places, pixel, 0));
    const vec3 shadingNormal = texelFetch(normals, pixel, 0).xyz;
    const vec3 normal = tablePoint(shadingNormal);
    vec3 irradiance = sunlight(points, shadingNormal);
#ifdef WITH_MEAN
    irradiance += tableAt(normal, 3 * layers).rgb;
#endif
    for (int i = 0; i < layers; ++i) {
        const vec4 k = valuesAt(coefficients, points, i);
        irradiance += vec3(dot(k, tableAt(normal, i)), dot(k, tableAt(normal, layers + i)),
                           dot(k, tableAt(normal, 2 * layers + i)));
    }
    // Measured as it is; shown without the negative lobes that truncation leaves in the dark.
    outIrradiance = vec4(irradiance, 1.0);
    outRadiance = vec4(texelFetch(albedos, pixel, 0).rgb / kPi * irradiance, 1.0);
}
