// Sources: [IwanickiSloan2012, Sec. 3]: E_c(n) = Σ_i k_i T_ci(n) (+ mean_c(n) for PCA), as in
// runtime/shaders/light.frag.
#include "compress/export_shaders.h"

#include <fmt/format.h>

#include <vector>

namespace prt {
namespace {

// What the two languages write differently.
struct Language {
    const char* vector3;
    const char* vector4;
    const char* arrayBegin;  ///< of a constant array of vector4
    const char* arrayEnd;
    const char* constant;
    const char* uniformArray;  ///< declares one, given type, name and size
    const char* pointParameters;
    const char* vertexParameters;
    const char* cube;  ///< parameters
    const char* cubeArguments;
    const char* lookUpPoint;
    const char* fetchVertex;
    const char* lookUpNormal;
    const char* needs;
};

constexpr Language kGlsl = {
    "vec3",
    "vec4",
    "vec4[](",
    ")",
    "const",
    "uniform {0} {1}[{2}];",
    "sampler2DArray image, vec2 uv",
    "sampler2DArray image, int vertex",
    "samplerCubeArray table",
    "table",
    "textureLod(image, vec3(uv, float(layer)), 0.0)",
    "texelFetch(image, ivec3(vertex % PRT_ROW_LENGTH, vertex / PRT_ROW_LENGTH, layer), 0)",
    "textureLod(table, vec4(normal, float(layer)), 0.0)",
    "GLSL 4.00, and glEnable(GL_TEXTURE_CUBE_MAP_SEAMLESS)",
};
constexpr Language kHlsl = {
    "float3",
    "float4",
    "{",
    "}",
    "static const",
    "cbuffer {1}s {{ {0} {1}[{2}]; }};",
    "Texture2DArray image, SamplerState linearClamp, float2 uv",
    "Texture2DArray image, int vertex",
    "TextureCubeArray table, SamplerState linearClamp",
    "table, linearClamp",
    "image.SampleLevel(linearClamp, float3(uv, float(layer)), 0.0)",
    "image.Load(int4(vertex % PRT_ROW_LENGTH, vertex / PRT_ROW_LENGTH, layer, 0))",
    "table.SampleLevel(linearClamp, float4(normal, float(layer)), 0.0)",
    "shader model 4.1",
};

std::string constantArray(const Language& language, const std::string& name, const std::string& size,
                          const std::vector<float>& values) {
    std::string text = fmt::format("{} {} {}[{}] = {}\n", language.constant, language.vector4, name, size,
                                   language.arrayBegin);
    for (size_t i = 0; i < values.size(); i += 4)
        text += fmt::format("    {}({:.9g}, {:.9g}, {:.9g}, {:.9g}){}\n", language.vector4, values[i],
                            values[i + 1], values[i + 2], values[i + 3], i + 4 < values.size() ? "," : "");
    return text + fmt::format("{};\n", language.arrayEnd);
}

// Functions of one kind of points and its tables.
struct Part {
    std::string name;    ///< "Weights"
    std::string layers;  ///< macro
    std::string count;   ///< macro
    std::string meaning;
    bool hasMean = false, isQuantized = false, hasTables = false, hasRanges = false;
};

std::string pointFunction(const Language& language, const ShaderSettings& settings, const Part& part) {
    return fmt::format(
        "\n/// {}, four of them: 4 * layer ... 4 * layer + 3, {}.\n{} prt{}({}, int layer) {{\n"
        "    return {}{};\n}}\n",
        part.meaning,
        settings.isPerVertex ? "of a vertex (interpolate them over the triangle)"
                             : "at a point of the atlas (TEXCOORD_1)",
        language.vector4, part.name,
        settings.isPerVertex ? language.vertexParameters : language.pointParameters,
        settings.isPerVertex ? language.fetchVertex : language.lookUpPoint,
        part.isQuantized ? " * prtWeightScale[layer] + prtWeightBias[layer]" : "");
}

std::string rangeDeclaration(const Language& language, const ShaderSettings& settings, const Part& part) {
    if (!part.hasRanges) return "";
    const std::string layers =
        (settings.isRgbPerLayer ? part.count : "3 * " + part.layers) + (part.hasMean ? " + 1" : "");
    return "\n// Of the table that is bound: \"range\" in the JSON file.\n" +
           fmt::format(fmt::runtime(language.uniformArray), language.vector4, "prt" + part.name + "Range",
                       layers) +
           "\n";
}

std::string tableFunctions(const Language& language, const ShaderSettings& settings, const Part& part) {
    const std::string v3 = language.vector3, v4 = language.vector4, table = "prt" + part.name + "Table";
    std::string decode = language.lookUpNormal;
    if (part.hasRanges)
        decode = fmt::format("{}(prt{}Range[layer].rgb, 0.0) + prt{}Range[layer].a * {}", v4, part.name,
                             part.name, decode);
    const auto lookUp = [&](const std::string& layer) {
        return fmt::format("{}({}, normal, {})", table, language.cubeArguments, layer);
    };
    std::string text = rangeDeclaration(language, settings, part);
    text += fmt::format("\n{} {}({}, {} normal, int layer) {{\n    return {};\n}}\n", v4, table,
                        language.cube, v3, decode);
    text += fmt::format(
        "\n/// Irradiance, linear RGB, may be a little below 0 in the dark. normal: world, of any "
        "length.\n{} prt{}Irradiance({} k[{}], {}, {} normal) {{\n",
        v3, part.name, v4, part.layers, language.cube, v3);
    const std::string mean = settings.isRgbPerLayer ? part.count : "3 * " + part.layers;
    text += fmt::format("    {} irradiance = {};\n", v3,
                        part.hasMean ? lookUp(mean) + ".rgb" : fmt::format("{}(0.0, 0.0, 0.0)", v3));
    if (settings.isRgbPerLayer)
        text += fmt::format("    for (int i = 0; i < {}; ++i) irradiance += k[i / 4][i % 4] * {}.rgb;\n",
                            part.count, lookUp("i"));
    else
        text += fmt::format(
            "    for (int i = 0; i < {0}; ++i)\n        irradiance += {1}(dot(k[i], {2}),\n"
            "                           dot(k[i], {3}),\n"
            "                           dot(k[i], {4}));\n",
            part.layers, v3, lookUp("i"), lookUp(part.layers + " + i"),
            lookUp("2 * " + part.layers + " + i"));
    return text + "    return irradiance;\n}\n";
}

std::string snippet(const Language& language, const ShaderSettings& settings) {
    std::string text = fmt::format(
        "// Irradiance from the textures beside this file; written by prt export. {}.json describes them.\n"
        "// Needs {}. Filter linearly, clamp to the edge, no smaller levels.\n"
        "// A diffuse surface reflects albedo / pi * max(irradiance, 0).\n\n",
        settings.name, language.needs);
    if (settings.isPerVertex) text += fmt::format("#define PRT_ROW_LENGTH {}\n", settings.rowLength);
    const auto define = [&](const char* prefix, int count) {
        text +=
            fmt::format("#define {0}_COUNT {1}\n#define {0}_LAYERS {2}\n", prefix, count, (count + 3) / 4);
    };
    if (settings.components > 0) {
        define("PRT_WEIGHT", settings.components);
        const bool isQuantized = !settings.weightRanges.empty();
        if (isQuantized) {
            std::vector<float> scale, bias;
            for (const UnormRange& range : settings.weightRanges) {
                scale.push_back(range.scale);
                bias.push_back(range.bias);
            }
            text += constantArray(language, "prtWeightScale", "PRT_WEIGHT_LAYERS", scale);
            text += constantArray(language, "prtWeightBias", "PRT_WEIGHT_LAYERS", bias);
        }
        const Part part{
            "Weights", "PRT_WEIGHT_LAYERS", "PRT_WEIGHT_COUNT",       "Weights of the components",
            true,      isQuantized,         settings.hasWeightTables, settings.hasWeightTableRanges};
        text += pointFunction(language, settings, part);
        if (part.hasTables) text += tableFunctions(language, settings, part);
    }
    if (settings.shCoefficients > 0) {
        text += "\n";
        define("PRT_VISIBILITY", settings.shCoefficients);
        const Part part{"Visibility",
                        "PRT_VISIBILITY_LAYERS",
                        "PRT_VISIBILITY_COUNT",
                        "SH coefficients of visibility",
                        false,
                        false,
                        settings.hasVisibilityTables,
                        settings.hasVisibilityTableRanges};
        text += pointFunction(language, settings, part);
        if (part.hasTables) text += tableFunctions(language, settings, part);
    }
    if (settings.hasSuns)
        text += fmt::format(
            "\n/// Irradiance of a sun, to be added to that of tables with \"extractSun\" \"yes\". shadow: "
            "red of its "
            "texture\n/// at the point; the next two: from \"suns\" in the JSON file. normal: world, of any "
            "length.\n"
            "{0} prtSunIrradiance(float shadow, {0} sunIrradiance, {0} sunDirection, {0} normal) {{\n"
            "    return sunIrradiance * (shadow * max(dot(normalize(normal), sunDirection), 0.0));\n}}\n",
            language.vector3);
    return text;
}

}  // namespace

std::string glslSnippet(const ShaderSettings& settings) { return snippet(kGlsl, settings); }
std::string hlslSnippet(const ShaderSettings& settings) { return snippet(kHlsl, settings); }

}  // namespace prt
