// Exposed radiance to what a display takes, as precompute/io/image.h has it.

// The ACES reference and display transforms of one channel, fitted. [Hill2016]
vec3 filmicChannels(vec3 x) { return (x * (x + 0.0245786) - 0.000090537) / (x * (0.983729 * x + 0.4329510) + 0.238081); }

vec3 filmic(vec3 colour) {
    const mat3 into = transpose(mat3(0.59719, 0.35458, 0.04823, 0.07600, 0.90834, 0.01566, 0.02840, 0.13383, 0.83777));
    const mat3 outOf =
        transpose(mat3(1.60475, -0.53108, -0.07367, -0.10208, 1.10813, -0.00605, -0.00327, -0.07276, 1.07602));
    return outOf * filmicChannels(into * (1.46193 * colour));  // middle grey, 0.18, stays
}

// [KhronosNeutral2024]
vec3 neutral(vec3 colour) {
    const float reflection = 0.04, start = 0.8 - reflection, desaturation = 0.15, room = 1.0 - start;
    const float least = min(colour.r, min(colour.g, colour.b));
    const vec3 lower = colour - (least < 2.0 * reflection ? least - least * least / (4.0 * reflection) : reflection);
    const float peak = max(lower.r, max(lower.g, lower.b));
    if (peak < start) return lower;
    const float newPeak = 1.0 - room * room / (peak + room - start);
    return mix(vec3(newPeak), lower * (newPeak / peak), 1.0 / (desaturation * (peak - newPeak) + 1.0));
}

/// The tone curve alone; linear, in [0, 1]. Curves: 0 none, 1 filmic, 2 neutral.
vec3 toneMapped(vec3 linear, int curve) {
    // Negative lobes and NaN are black; what is far beyond white stays a number.
    const vec3 colour = vec3(linear.r > 0.0 ? min(linear.r, 1e6) : 0.0, linear.g > 0.0 ? min(linear.g, 1e6) : 0.0,
                             linear.b > 0.0 ? min(linear.b, 1e6) : 0.0);
    return clamp(curve == 1 ? filmic(colour) : curve == 2 ? neutral(colour) : colour, 0.0, 1.0);
}

uniform int toneCurve;  // less than 0: linear, unexposed
uniform float exposure;

/// Radiance as a display takes it, but for the sRGB curve.
vec3 shown(vec3 radiance) { return toneCurve < 0 ? radiance : toneMapped(exposure * radiance, toneCurve); }

/// [IEC61966-2-1]
vec3 srgbFromLinear(vec3 linear) {
    return mix(1.055 * pow(linear, vec3(1.0 / 2.4)) - 0.055, 12.92 * linear, lessThanEqual(linear, vec3(0.0031308)));
}
