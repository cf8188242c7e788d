// A weighted sum of images of many layers, texel by texel.
layout(binding = 0) uniform sampler2DArray sources[SOURCES];

uniform float weights[SOURCES];

layout(location = 0) out vec4 outSum;

void main() {
    const ivec3 texel = ivec3(gl_FragCoord.xy, gl_Layer);
    outSum = vec4(0.0);
    for (int i = 0; i < SOURCES; ++i) outSum += weights[i] * texelFetch(sources[i], texel, 0);
}
