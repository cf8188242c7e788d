// Lookups in a table over normals: a 2D array, bilinear, of three colours × TABLE_LAYERS groups of four coefficients
// and, of triple products, a mean in RGB. A group is kGroupImages images of the layout; those of math/table_layout.h.
//   TABLE_SIZE    texels along the side of a face, without a border
//   TABLE_LAYERS  groups of a colour; both are constants, so that loops over them are unrolled
layout(binding = 5) uniform sampler2DArray table;

/// Where a unit normal falls on: a point in [0, 1]², and which image of a group.
#if defined(TABLE_DUAL_PARABOLOID)
const int kGroupImages = 1;

vec3 tablePoint(vec3 normal) {
    const vec3 st = dualParaboloidPoint(normal);
    const float size = float(TABLE_SIZE);
    const vec2 texel = 0.5 + (0.5 * st.xy + 0.5) * (size - 1.0);
    return vec3((st.z * size + texel.x) / (2.0 * size), texel.y / size, 0.0);
}
#elif defined(TABLE_OCTAHEDRAL)
const int kGroupImages = 1;

vec3 tablePoint(vec3 normal) {
    const vec2 texel = 1.0 + (0.5 * octahedralPoint(normal) + 0.5) * float(TABLE_SIZE);
    return vec3(texel / float(TABLE_SIZE + 2), 0.0);
}
#else
const int kGroupImages = 6;  // each within a border of one texel of its neighbours

vec3 tablePoint(vec3 normal) {
    vec2 point;
    const int face = cubeFace(normal, point);
    return vec3(((point * 0.5 + 0.5) * float(TABLE_SIZE) + 1.0) / float(TABLE_SIZE + 2), face);
}
#endif

vec4 tableAt(vec3 point, int group) {
    return textureLod(table, vec3(point.xy, float(kGroupImages * group) + point.z), 0.0);
}

/// Sum of coefficients 4i … 4i + 3 × what the table has for them, per colour.
vec3 tableSum(vec3 point, int i, vec4 coefficients) {
    return vec3(dot(coefficients, tableAt(point, i)), dot(coefficients, tableAt(point, TABLE_LAYERS + i)),
                dot(coefficients, tableAt(point, 2 * TABLE_LAYERS + i)));
}

/// Of triple products: what is added whatever the coefficients are.
vec3 tableMean(vec3 point) { return tableAt(point, 3 * TABLE_LAYERS).rgb; }
