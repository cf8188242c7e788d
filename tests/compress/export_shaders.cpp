// The exported GLSL, compiled and run over the exported textures, against the same sums on the CPU.
#include "compress/export_shaders.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <random>

#include "compress/export_textures.h"
#include "compress/tables/normal_tables.h"
#include "precompute/io/ktx2.h"
#include "runtime/gl_context.h"
#include "runtime/gl_objects.h"
#include "tests/compress/export_fixture.h"

namespace prt {
namespace {

constexpr int kPoints = 512;

struct Upload {
    GLenum internalFormat, format, type;
};

Upload uploadOf(TexelFormat format) {
    switch (format) {
        case TexelFormat::Rgba8Unorm:
            return {GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE};
        case TexelFormat::Rgba16Unorm:
            return {GL_RGBA16, GL_RGBA, GL_UNSIGNED_SHORT};
        case TexelFormat::Rgba16Float:
            return {GL_RGBA16F, GL_RGBA, GL_HALF_FLOAT};
        case TexelFormat::Rgb9e5:
            return {GL_RGB9_E5, GL_RGB, GL_UNSIGNED_INT_5_9_9_9_REV};
        case TexelFormat::R11fG11fB10f:
            return {GL_R11F_G11F_B10F, GL_RGB, GL_UNSIGNED_INT_10F_11F_11F_REV};
        default:
            return {GL_RGBA32F, GL_RGBA, GL_FLOAT};
    }
}

GlObject upload(const GlFunctions& gl, const TextureImage& image) {
    GlObject texture = makeTexture(gl, image.isCube ? GL_TEXTURE_CUBE_MAP_ARRAY : GL_TEXTURE_2D_ARRAY);
    for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
        gl.TextureParameteri(texture.name(), filter, GL_LINEAR);
    for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
        gl.TextureParameteri(texture.name(), wrap, GL_CLAMP_TO_EDGE);
    const auto [internalFormat, format, type] = uploadOf(image.format);
    const int depth = image.layers * (image.isCube ? 6 : 1);
    gl.TextureStorage3D(texture.name(), 1, internalFormat, image.width, image.height, depth);
    gl.TextureSubImage3D(texture.name(), 0, 0, 0, 0, image.width, image.height, depth, format, type,
                         image.bytes.data());
    return texture;
}

GlObject compileProgram(const GlFunctions& gl, const std::string& fragment) {
    const std::string vertex =
        "#version 450 core\nvoid main() {\n"
        "gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0); }\n";
    GlObject program(gl, gl.CreateProgram(), [](const GlFunctions& f, GLuint n) { f.DeleteProgram(n); });
    for (const auto& [stage, text] : {std::pair(GL_VERTEX_SHADER, vertex), {GL_FRAGMENT_SHADER, fragment}}) {
        const GlObject shader(gl, gl.CreateShader(GLenum(stage)),
                              [](const GlFunctions& f, GLuint n) { f.DeleteShader(n); });
        const char* source = text.c_str();
        gl.ShaderSource(shader.name(), 1, &source, nullptr);
        gl.CompileShader(shader.name());
        GLint compiled = 0;
        gl.GetShaderiv(shader.name(), GL_COMPILE_STATUS, &compiled);
        char log[4096] = "";
        gl.GetShaderInfoLog(shader.name(), sizeof log, nullptr, log);
        EXPECT_TRUE(compiled) << log << "\n" << text;
        gl.AttachShader(program.name(), shader.name());
    }
    gl.LinkProgram(program.name());
    return program;
}

// Where a shader is evaluated: one pixel each.
struct Points {
    std::vector<float> place;   // [N×4] uv, or the vertex
    std::vector<float> normal;  // [N×4] of lengths other than 1
    std::vector<size_t> texel;
};

Points randomPoints(const PointGrid& grid) {
    Points points;
    std::mt19937 random(9);
    std::normal_distribution<float> gauss;
    for (int i = 0; i < kPoints; ++i) {
        const size_t texel = random() % grid.count;
        const int x = int(texel) % grid.width, y = int(texel) / grid.width;
        const bool isVertex = grid.domain == PointDomain::Vertex;
        points.texel.push_back(texel);
        points.place.insert(points.place.end(),
                            {isVertex ? float(texel) : (float(x) + 0.5f) / float(grid.width),
                             (float(y) + 0.5f) / float(grid.height), 0, 0});
        for (int c = 0; c < 3; ++c) points.normal.push_back(gauss(random));
        points.normal.push_back(0);
    }
    return points;
}

GlObject floatImage(const GlFunctions& gl, const std::vector<float>& texels) {
    GlObject image = makeImage(gl, GL_RGBA32F, kPoints, 1);
    gl.TextureSubImage2D(image.name(), 0, 0, 0, kPoints, 1, GL_RGBA, GL_FLOAT, texels.data());
    return image;
}

// Ranges as a constant in place of the uniform that an engine would fill.
std::string withRanges(std::string text, const json& table, const std::string& name) {
    const size_t begin = text.find("uniform vec4 " + name);
    EXPECT_EQ(begin != std::string::npos, table.contains("range"));
    if (begin == std::string::npos) return text;
    std::string values;
    for (const json& range : table["range"])
        values += fmt::format("{}vec4({:.9g}, {:.9g}, {:.9g}, {:.9g})", values.empty() ? "" : ", ",
                              range[0].get<float>(), range[1].get<float>(), range[2].get<float>(),
                              range[3].get<float>());
    const size_t end = text.find(';', begin);
    return text.replace(begin, end - begin, "const vec4 " + name + "[] = vec4[](" + values + ")");
}

std::string fragmentShader(const std::string& snippet, const std::string& name, const std::string& layers,
                           bool isPerVertex) {
    return "#version 450 core\n" + snippet +
           "\nlayout(binding = 0) uniform sampler2D places;\nlayout(binding = 1) uniform sampler2D normals;\n"
           "layout(binding = 2) uniform sampler2DArray points;\nlayout(binding = 3) uniform samplerCubeArray "
           "tables;\n"
           "layout(location = 0) out vec4 result;\nvoid main() {\n"
           "    ivec2 pixel = ivec2(gl_FragCoord.xy);\n    vec4 place = texelFetch(places, pixel, 0);\n"
           "    vec4 k[" +
           layers + "];\n    for (int i = 0; i < " + layers + "; ++i) k[i] = prt" + name + "(points, " +
           (isPerVertex ? "int(place.x)" : "place.xy") + ", i);\n    result = vec4(prt" + name +
           "Irradiance(k, tables, texelFetch(normals, pixel, 0).xyz)" +
           (snippet.find("prtSunIrradiance") == std::string::npos
                ? ""
                : " + prtSunIrradiance(0.5, vec3(3.0, 2.5, 1.0), vec3(0.6, 0.8, 0.0), texelFetch(normals, "
                  "pixel, "
                  "0).xyz)") +
           ", 1.0);\n}\n";
}

class ExportedGlsl : public Export {
  protected:
    // Irradiance of the points by the shader, from files alone.
    std::vector<float> shade(const GlContext& context, const Points& points, const json& text,
                             bool isTriple) {
        const GlFunctions& gl = context.gl();
        const std::string name = isTriple ? "Weights" : "Visibility";
        json table;
        for (const json& one : text["tables"])
            if ((one["kind"] == "triple-product") == isTriple) table = one;
        const std::string snippet =
            withRanges(readFile(out() / "prt_shade.glsl"), table, "prt" + name + "Range");
        const GlObject program = compileProgram(
            gl, fragmentShader(snippet, name, isTriple ? "PRT_WEIGHT_LAYERS" : "PRT_VISIBILITY_LAYERS",
                               text["domain"] == "vertex"));
        const std::string part = isTriple ? "weights" : "visibility";
        const GlObject values = upload(gl, readKtx2(out() / text[part]["file"].get<std::string>()));
        const GlObject tables = upload(gl, readKtx2(out() / table["file"].get<std::string>()));
        const GlObject places = floatImage(gl, points.place), normals = floatImage(gl, points.normal);
        const GlObject result = makeImage(gl, GL_RGBA32F, kPoints, 1),
                       depth = makeImage(gl, GL_DEPTH_COMPONENT32F, kPoints, 1);
        const GlObject framebuffer = makeFramebufferOver(gl, {result.name()}, depth.name());
        const GlObject vertexArray = makeVertexArray(gl);
        gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer.name());
        gl.BindVertexArray(vertexArray.name());
        gl.UseProgram(program.name());
        gl.Enable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
        gl.Disable(GL_DEPTH_TEST);
        gl.Viewport(0, 0, kPoints, 1);
        GLuint unit = 0;
        for (const GlObject* texture : {&places, &normals, &values, &tables})
            gl.BindTextureUnit(unit++, texture->name());
        gl.DrawArrays(GL_TRIANGLES, 0, 3);
        std::vector<float> pixels(size_t(kPoints) * 4);
        gl.GetTextureImage(result.name(), 0, GL_RGBA, GL_FLOAT, GLsizei(pixels.size() * sizeof(float)),
                           pixels.data());
        context.check("shading");
        return pixels;
    }

    // The same on the CPU, from what the formats leave of the bundle.
    void compare(const ExportSettings& one) {
        const GlContext context;
        runExport(one);
        const json text = description();
        const VisibilityMap map = readVisibilityFile(bundle() + "/visibility.exr");
        const PcaMap pca = readPcaFile(bundle() + "/pca.exr");
        const Points points = randomPoints(map.grid);
        std::vector<uint8_t> used;
        for (const Validity validity : map.validity) used.push_back(validity != Validity::Empty);
        for (const bool isTriple : {true, false}) {
            const NormalTable table =
                readTableFile(bundle() + (isTriple ? "/tables/clear.triple-product.cube.exr"
                                                   : "/tables/clear.light-cosine.cube.exr"));
            const TableTexture texture = encodeTable(table, one.tables);
            const size_t perPoint = isTriple ? size_t(pca.components) : size_t(table.layers);
            const PointTexture values =
                isTriple ? encodePoints(pca.weights, perPoint, pca.grid, one.weights, used)
                         : encodePoints(map.coefficients, perPoint, map.grid, one.visibility, used);
            const std::vector<float> shaded = shade(context, points, text, isTriple);
            double worst = 0, largest = 0;
            for (size_t i = 0; i < points.texel.size(); ++i) {
                const Vec3f normal(points.normal[i * 4], points.normal[i * 4 + 1], points.normal[i * 4 + 2]);
                const std::vector<float> looked =
                    lookUpTable(texture.decoded, table.layers, table.size, normal.cast<double>());
                for (size_t c = 0; c < 3; ++c) {
                    const float* functions = looked.data() + c * size_t(table.layers);
                    double expected = isTriple ? double(functions[perPoint]) : 0;
                    for (size_t m = 0; m < perPoint; ++m)
                        expected +=
                            double(values.decoded[points.texel[i] * perPoint + m]) * double(functions[m]);
                    if (!text["suns"].empty())
                        expected += 0.5 * std::array{3.0, 2.5, 1.0}[c] *
                                    std::max(0.0f, normal.normalized().dot(Vec3f(0.6f, 0.8f, 0)));
                    worst = std::max(worst, std::abs(expected - double(shaded[i * 4 + c])));
                    largest = std::max(largest, std::abs(expected));
                }
            }
            EXPECT_GT(largest, 1);
            EXPECT_LT(worst, 1e-3 * largest) << one.tables << " " << one.weights << " " << isTriple;
        }
    }
};

TEST_F(ExportedGlsl, ShadesAsTheCpuDoesInEveryFormat) {
    writeBundle(bakedVisibility(kAtlas, 4), 7);
    tabulate("triple-product");
    tabulate("light-cosine");
    addSun(kAtlas);
    const std::vector<std::pair<const char*, const char*>> formats = {
        {"unorm8", "half"}, {"unorm16", "rgb9e5"}, {"half", "r11f"}, {"float", "float"}};
    for (const auto& [weights, tables] : formats) {
        ExportSettings one = settings();
        one.weights = weights;
        one.tables = tables;
        one.visibility = "half";
        compare(one);
    }
}

TEST_F(ExportedGlsl, ShadesVertices) {
    writeBundle(bakedVisibility(vertexGrid(1500), 3), 4);
    tabulate("triple-product");
    tabulate("light-cosine");
    ExportSettings one = settings();
    one.visibility = "float";
    compare(one);
}

}  // namespace
}  // namespace prt
