// Sends each triangle to its layer.
layout(triangles) in;
layout(triangle_strip, max_vertices = 3) out;

flat in int layer[];

void main() {
    for (int i = 0; i < 3; ++i) {
        gl_Layer = layer[i];
        gl_Position = gl_in[i].gl_Position;
        EmitVertex();
    }
    EndPrimitive();
}
