// Irradiance of what is seen, k the coefficients at the point, n the shading normal.
//   (none), WITH_MEAN  E_c = Σ_i k_i T_ci(n) (+ mean_c(n)), k SH of visibility or PCA weights, T a table
//   PRECONVOLVED       E_c = k T_c(n), k ambient occlusion, T unoccluded irradiance
//   UNIFORM_PRODUCTS   E_c = Σ_j f_j(n) (P_jc,mean + Σ_i k_i P_jci), f functions of the clamped cosine
//   TWO_BANDS          E_c = ∫ V L_c max(0, n·ω) dω, V and L of two bands
//   LIGHTMAP           E_c = Σ_i k_ci A_i Y_i(n), k radiance of three bands that arrives at the point
//   BASE_PASS          E_c = 1: what a frame costs without its light
//   POINT_COLOURS      no light: the first three values of the point as they are
// [IwanickiSloan2012, Sec. 3 to 5]
#ifdef MULTISAMPLED
#include "environment.glsl"
#include "tone_curve.glsl"
#define SURFACES sampler2DMS
#define TRIANGLES usampler2DMS
#else
#define SURFACES sampler2D
#define TRIANGLES usampler2D
#endif
layout(binding = 0) uniform SURFACES places;
layout(binding = 1) uniform SURFACES normals;
layout(binding = 2) uniform SURFACES albedos;
layout(binding = 3) uniform TRIANGLES triangles;
layout(binding = 4) uniform sampler2DArray coefficients;  // [layers], four coefficients each
layout(binding = 6) uniform usamplerBuffer indices;
layout(binding = 7) uniform sampler2DArray sunShadows;  // four suns to a layer

uniform ivec2 gridSize;
uniform int sunCount, sunsPerTexel;
uniform vec3 sunDirection[8], sunIrradiance[8];

layout(location = 0) out vec4 outRadiance;
layout(location = 1) out vec4 outIrradiance;

#ifdef TABLE_SIZE
#include "table.glsl"
#endif

#ifdef PER_VERTEX
struct Points {
    ivec2 corner[3];
    vec3 weights;
    vec2 atlas;
};

ivec2 gridPoint(uint index) {
    const int vertex = int(texelFetch(indices, int(index)).r);
    return ivec2(vertex % gridSize.x, vertex / gridSize.x);
}

Points pointsAt(uint triangle, vec4 place) {
    const uint first = triangle * 3u;
    // Pixels whose centre lies a little outside of the triangle must not extrapolate.
    vec3 b = max(vec3(1.0 - place.x - place.y, place.xy), 0.0);
#ifdef NEAREST_POINT
    b = b.x >= max(b.y, b.z) ? vec3(1.0, 0.0, 0.0) : b.y >= b.z ? vec3(0.0, 1.0, 0.0) : vec3(0.0, 0.0, 1.0);
#endif
    return Points(ivec2[3](gridPoint(first), gridPoint(first + 1u), gridPoint(first + 2u)), b / (b.x + b.y + b.z),
                  place.zw);
}

vec4 valuesAt(sampler2DArray image, Points points, int layer) {
    return points.weights.x * texelFetch(image, ivec3(points.corner[0], layer), 0) +
           points.weights.y * texelFetch(image, ivec3(points.corner[1], layer), 0) +
           points.weights.z * texelFetch(image, ivec3(points.corner[2], layer), 0);
}
#else
#define Points vec2

Points pointsAt(uint triangle, vec4 place) { return place.zw; }

vec4 valuesAt(sampler2DArray image, Points point, int layer) { return textureLod(image, vec3(point, layer), 0.0); }
#endif

#ifdef PER_VERTEX
/// Weights may be at the vertices of a mesh whose other data are in an atlas.
vec4 shadowsAt(Points points, int layer) {
    return sunsPerTexel != 0 ? textureLod(sunShadows, vec3(points.atlas, layer), 0.0)
                             : valuesAt(sunShadows, points, layer);
}
#else
vec4 shadowsAt(Points point, int layer) { return valuesAt(sunShadows, point, layer); }
#endif

/// Each sun: what it sends to a surface of this normal, times the share of its disc that the point sees.
vec3 sunlight(Points points, vec3 normal) {
    vec3 sum = vec3(0.0);
#ifndef LIGHTMAP  // which has them already
    for (int i = 0; i < sunCount; ++i)
        sum += sunIrradiance[i] * max(dot(normal, sunDirection[i]), 0.0) * shadowsAt(points, i / 4)[i % 4];
#endif
    return sum;
}

#if defined(TWO_BANDS)
uniform vec3 light[4];  // L(ω) = light[0] + light[1] ω.x + light[2] ω.y + light[3] ω.z

/// The product of two linear functions has nine coefficients, and the bands of the cosine beyond the third do
/// not meet it: with ∫ H = π, ∫ ω H = 2π/3 n and ∫ ω ωᵀ H = π/4 (1 + n nᵀ) it is convolved without its
/// coefficients.
vec3 irradianceAt(Points points, vec3 n) {
    const vec4 k = valuesAt(coefficients, points, 0);
    const float constant = sqrt(1.0 / (4.0 * kPi)) * k.x;
    const vec3 gradient = sqrt(3.0 / (4.0 * kPi)) * vec3(-k.w, -k.y, k.z);
    const float along = dot(gradient, n);
    const vec3 lightAlong = light[1] * n.x + light[2] * n.y + light[3] * n.z;
    const vec3 both = light[1] * gradient.x + light[2] * gradient.y + light[3] * gradient.z;
    return constant * (kPi * light[0] + (2.0 / 3.0 * kPi) * lightAlong) +
           along * ((2.0 / 3.0 * kPi) * light[0] + (0.25 * kPi) * lightAlong) + (0.25 * kPi) * both;
}
#elif defined(UNIFORM_PRODUCTS)
const int kLayers = (VECTORS + 3) / 4;
uniform vec3 products[COSINE_FUNCTIONS * (VECTORS + 1)];  // scales of Y and bands of the cosine are in them

// Loops, although llvmpipe reads uniforms faster where their index is a constant: unrolled, 24 vectors take it
// minutes to compile.
vec3 productAt(int function, vec4 weights[kLayers]) {
    const int first = function * (VECTORS + 1);
    vec3 sum = products[first + VECTORS];
    for (int i = 0; i < VECTORS; ++i) sum += weights[i / 4][i % 4] * products[first + i];
    return sum;
}

/// SH by recurrence along l for every m; bands 3, 5, 7 … of a clamped cosine are zero.
vec3 irradianceAt(Points points, vec3 n) {
    vec4 weights[kLayers];
    for (int i = 0; i < kLayers; ++i) weights[i] = valuesAt(coefficients, points, i);
    vec3 sum = vec3(0.0);
    vec2 turned = vec2(1.0, 0.0);  // sin^m θ (cos mφ, sin mφ)
    int at = 0;
    for (int m = 0; m < COSINE_BANDS; ++m) {
        float before = 0.0, legendre = 1.0;
        for (int l = m; l < COSINE_BANDS; ++l) {
            if (l <= 1 || l % 2 == 0) {
                sum += legendre * turned.x * productAt(at++, weights);
                if (m > 0) sum += legendre * turned.y * productAt(at++, weights);
            }
            const float next = (float(2 * l + 1) * n.z * legendre - float(l + m) * before) / float(l - m + 1);
            before = legendre;
            legendre = next;
        }
        turned = vec2(turned.x * n.x - turned.y * n.y, turned.x * n.y + turned.y * n.x);
    }
    return sum;
}
#elif defined(LIGHTMAP)
/// Bands of the clamped cosine [RamamoorthiHanrahan2001, Eq. 19]. Layers 2c and 2c + 1 are coefficients 1 … 4 and
/// 5 … 8 of colour c, layer 6 is coefficient 0 of all.
vec3 irradianceAt(Points points, vec3 n) {
    const float b0 = kPi * sqrt(1.0 / (4.0 * kPi)), b1 = 2.0 / 3.0 * kPi * sqrt(3.0 / (4.0 * kPi)),
                b2 = 0.25 * kPi * sqrt(15.0 / (4.0 * kPi));
    const vec4 first = vec4(-b1 * n.y, b1 * n.z, -b1 * n.x, b2 * n.x * n.y);
    const vec4 second = vec4(-b2 * n.y * n.z, b2 / sqrt(12.0) * (3.0 * n.z * n.z - 1.0), -b2 * n.x * n.z,
                             0.5 * b2 * (n.x * n.x - n.y * n.y));
    vec3 sum = b0 * valuesAt(coefficients, points, 6).rgb;
    for (int c = 0; c < 3; ++c)
        sum[c] += dot(first, valuesAt(coefficients, points, 2 * c)) + dot(second, valuesAt(coefficients, points, 2 * c + 1));
    return sum;
}
#elif defined(BASE_PASS)
vec3 irradianceAt(Points points, vec3 n) { return vec3(1.0); }
#elif defined(POINT_COLOURS)
vec3 irradianceAt(Points points, vec3 n) { return valuesAt(coefficients, points, 0).rgb; }
#elif defined(PRECONVOLVED)
vec3 irradianceAt(Points points, vec3 n) { return valuesAt(coefficients, points, 0).r * tableMean(tablePoint(n)); }
#else
vec3 irradianceAt(Points points, vec3 n) {
    const vec3 normal = tablePoint(n);
    vec3 sum = vec3(0.0);
#ifdef WITH_MEAN
    sum += tableMean(normal);
#endif
    for (int i = 0; i < TABLE_LAYERS; ++i) sum += tableSum(normal, i, valuesAt(coefficients, points, i));
    return sum;
}
#endif

/// Irradiance of what one sample of a pixel sees, and the radiance that it sends.
vec3 irradianceOf(ivec2 pixel, int index, uint triangle, out vec3 radiance) {
    const Points points = pointsAt(triangle, texelFetch(places, pixel, index));
    const vec3 normal = texelFetch(normals, pixel, index).xyz;
    const vec3 irradiance = sunlight(points, normal) + irradianceAt(points, normal);
#ifdef POINT_COLOURS
    radiance = irradiance;
#else
    // Measured as it is; shown without the negative lobes that truncation leaves in the dark.
    radiance = texelFetch(albedos, pixel, index).rgb / kPi * irradiance;
#endif
    return irradiance;
}

#if defined(MULTISAMPLED) && defined(ONE_TRIANGLE)
/// All samples see the same.
void main() {
    const ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec3 radiance;
    outIrradiance = vec4(irradianceOf(pixel, 0, texelFetch(triangles, pixel, 0).r, radiance), 1.0);
    outRadiance = vec4(shown(radiance), 1.0);
}
#elif defined(MULTISAMPLED)
uniform int hasEnvironment;

/// Each triangle is lit once; samples are averaged as they are shown, so that an edge before a bright sky is
/// as smooth as any other. Some sample sees a triangle.
void main() {
    const ivec2 pixel = ivec2(gl_FragCoord.xy);
    uvec4 seen;
    for (int i = 0; i < kSamples; ++i) seen[i] = texelFetch(triangles, pixel, i).r;
    bvec4 done = equal(seen, uvec4(kNoTriangle));
    const float none = dot(vec4(done), vec4(1.0));
    vec3 radiances = vec3(0.0), irradiances = vec3(0.0);
    do {
        const int i = !done.x ? 0 : !done.y ? 1 : !done.z ? 2 : 3;
        const bvec4 same = equal(seen, uvec4(seen[i]));
        const float count = dot(vec4(same), vec4(1.0));
        vec3 radiance;
        irradiances += count * irradianceOf(pixel, i, seen[i], radiance);
        radiances += count * shown(radiance);
        done = bvec4(done.x || same.x, done.y || same.y, done.z || same.z, done.w || same.w);
    } while (!all(done));
    if (none > 0.0 && hasEnvironment != 0) radiances += none * shown(environmentAt(gl_FragCoord.xy));
    outIrradiance = vec4(irradiances / max(float(kSamples) - none, 1.0), 1.0);
    outRadiance = vec4(radiances / float(kSamples), 1.0);
}
#else
void main() {
    const ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec3 radiance;
    outIrradiance = vec4(irradianceOf(pixel, 0, texelFetch(triangles, pixel, 0).r, radiance), 1.0);
    outRadiance = vec4(radiance, 1.0);
}
#endif
