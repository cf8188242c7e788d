// A linear image as a display shows it. Its top row goes to the top of a framebuffer whose origin is below.
#include "tone_curve.glsl"

layout(binding = 0) uniform sampler2D radiance;

uniform ivec2 corner;  // lower left one of the image in the framebuffer

layout(location = 0) out vec4 outColour;

void main() {
    const ivec2 place = ivec2(gl_FragCoord.xy) - corner;
    const ivec2 pixel = ivec2(place.x, textureSize(radiance, 0).y - 1 - place.y);
    outColour = vec4(srgbFromLinear(shown(texelFetch(radiance, pixel, 0).rgb)), 1.0);
}
