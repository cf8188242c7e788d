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

// Filtering is done here: hardware filters with 8 bits of weight on many GPUs, and the four texels are the same
// in all layers.
struct Taps {
    ivec2 from, to;  // opposite corners
    vec4 weights;    // of (from.x, from.y), (to.x, from.y), (from.x, to.y), (to.x, to.y)
};

vec4 bilinearWeights(vec2 f) {
    return vec4((1.0 - f.x) * (1.0 - f.y), f.x * (1.0 - f.y), (1.0 - f.x) * f.y, f.x * f.y);
}

vec4 filtered(sampler2DArray image, Taps taps, int layer) {
    return taps.weights.x * texelFetch(image, ivec3(taps.from, layer), 0) +
           taps.weights.y * texelFetch(image, ivec3(taps.to.x, taps.from.y, layer), 0) +
           taps.weights.z * texelFetch(image, ivec3(taps.from.x, taps.to.y, layer), 0) +
           taps.weights.w * texelFetch(image, ivec3(taps.to, layer), 0);
}

Taps tableTaps(vec2 point) {
    // From face texels (centres at half-integers) to bordered texels: + 1; to tap indices: - 1/2.
    const vec2 texel = (point * 0.5 + 0.5) * float(tableSize) + 0.5;
    Taps taps;
    taps.from = min(ivec2(texel), ivec2(tableSize));
    taps.to = taps.from + 1;
    taps.weights = bilinearWeights(texel - vec2(taps.from));
    return taps;
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
#define Points Taps

Points pointsAt(ivec2 pixel, vec4 place) {
    const vec2 texel = place.zw * vec2(gridSize) - 0.5;
    const vec2 base = floor(texel);
    return Taps(clamp(ivec2(base), ivec2(0), gridSize - 1), clamp(ivec2(base) + 1, ivec2(0), gridSize - 1),
                bilinearWeights(texel - base));
}

vec4 coefficientsAt(Points points, int layer) { return filtered(coefficients, points, layer); }
#endif

void main() {
    const ivec2 pixel = ivec2(gl_FragCoord.xy);
    const Points points = pointsAt(pixel, texelFetch(places, pixel, 0));
    vec2 facePoint;
    const int face = cubeFace(texelFetch(normals, pixel, 0).xyz, facePoint);
    const Taps normal = tableTaps(facePoint);
    vec3 irradiance = vec3(0.0);
#ifdef WITH_MEAN
    irradiance = filtered(table, normal, 18 * layers + face).rgb;
#endif
    for (int i = 0; i < layers; ++i) {
        const vec4 k = coefficientsAt(points, i);
        irradiance += vec3(dot(k, filtered(table, normal, 6 * i + face)),
                           dot(k, filtered(table, normal, 6 * (layers + i) + face)),
                           dot(k, filtered(table, normal, 6 * (2 * layers + i) + face)));
    }
    // Measured as it is; shown without the negative lobes that truncation leaves in the dark.
    outIrradiance = vec4(irradiance, 1.0);
    outRadiance = vec4(texelFetch(albedos, pixel, 0).rgb / kPi * max(irradiance, 0.0), 1.0);
}
