// What is behind the scene, where nothing is seen.
#include "environment.glsl"

layout(location = 0) out vec4 outRadiance;
layout(location = 1) out vec4 outIrradiance;

void main() {
    outRadiance = vec4(environmentAt(gl_FragCoord.xy), 1.0);
    outIrradiance = vec4(0.0);
}
