// Sorts pixels of several samples, by depth: 0 nothing is seen, 1/4 one triangle alone, 1/2 more than one thing.
layout(binding = 3) uniform usampler2DMS triangles;

void main() {
    const ivec2 pixel = ivec2(gl_FragCoord.xy);
    const uint first = texelFetch(triangles, pixel, 0).r;
    bool same = true;
    for (int i = 1; i < kSamples; ++i) same = same && texelFetch(triangles, pixel, i).r == first;
    gl_FragDepth = !same ? 0.5 : first == kNoTriangle ? 0.0 : 0.25;
}
