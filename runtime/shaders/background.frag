// What is behind the scene, where nothing is seen.
#include "environment.glsl"
#ifdef MULTISAMPLED
#include "tone_curve.glsl"
#endif

layout(location = 0) out vec4 outRadiance;
layout(location = 1) out vec4 outIrradiance;

void main() {
    const vec3 radiance = environmentAt(gl_FragCoord.xy);
#ifdef MULTISAMPLED
    outRadiance = vec4(shown(radiance), 1.0);
#else
    outRadiance = vec4(radiance, 1.0);
#endif
    outIrradiance = vec4(0.0);
}
