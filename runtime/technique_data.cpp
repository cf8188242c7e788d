// Sources: [IwanickiSloan2012, Sec. 3 to 5]; the clamped cosine's bands [RamamoorthiHanrahan2001, Eq. 19].
#include "runtime/technique_data.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/math/clamped_cosine.h"
#include "precompute/math/sh.h"
#include "precompute/math/sh_product.h"

namespace prt {
namespace {

const char* layoutDefine(const std::string& layout) {
    if (layout == "dual-paraboloid") return "#define TABLE_DUAL_PARABOLOID\n";
    return layout == "octahedral" ? "#define TABLE_OCTAHEDRAL\n" : "";
}

// Y_lm over what light.frag evaluates: (2m−1)!!⁻¹ P_lm(z) sin^m θ {cos mφ, sin mφ}, P without its sign.
double functionScale(int l, int m) {
    double scale = (2 * l + 1) / (4 * std::numbers::pi);
    for (int k = l - m + 1; k <= l + m; ++k) scale /= k;
    scale = std::sqrt(scale * (m > 0 ? 2 : 1));
    for (int k = 1; k < 2 * m; k += 2) scale *= k;
    return m % 2 ? -scale : scale;
}

// Seven texels of four: coefficients 1 … 4 and 5 … 8 of each colour, then coefficient 0 of all three.
constexpr int kPackedLightmap = 28;
std::vector<float> packLightmap(const Lightmap& map) {
    PRT_CHECK_EQ(map.coefficients.size(), map.grid.count * 3 * kLightmapCoefficients);
    std::vector<float> packed(map.grid.count * kPackedLightmap, 0.0f);
    for (size_t point = 0; point < map.grid.count; ++point)
        for (size_t colour = 0; colour < 3; ++colour) {
            const float* from = &map.coefficients[(point * 3 + colour) * kLightmapCoefficients];
            float* to = &packed[point * kPackedLightmap];
            to[24 + colour] = from[0];
            std::copy_n(from + 1, 8, to + 8 * colour);
        }
    return packed;
}

}  // namespace

bool usesTable(Technique technique) {
    return technique.kind == TechniqueKind::Unc || technique.kind == TechniqueKind::Pca ||
           technique.kind == TechniqueKind::VertexPca || technique.kind == TechniqueKind::PreconvolvedAo;
}

TableKind tableKindOf(Technique technique) {
    return technique.kind == TechniqueKind::Unc ? TableKind::LightCosine : TableKind::TripleProduct;
}

std::vector<Vec3f> uniformProducts(const EnvironmentSh& light, const PcaMap& basis, int cosineBands) {
    PRT_CHECK_LE(basis.shOrder + cosineBands - 1, light.shOrder);
    const size_t columns = size_t(shCount(basis.shOrder)), rows = size_t(shCount(cosineBands)),
                 vectors = size_t(basis.components) + 1;
    std::vector<Vec3f> products(size_t(cosineFunctionCount(cosineBands)) * vectors);
    std::vector<float> product(rows);
    for (size_t colour = 0; colour < 3; ++colour) {
        const std::vector<float> matrix = productMatrix(light.rgb[colour], cosineBands, basis.shOrder);
        for (size_t vector = 0; vector < vectors; ++vector) {
            const std::span<const float> expansion =
                vector + 1 == vectors ? std::span(basis.mean)
                                      : std::span(basis.basis).subspan(vector * columns, columns);
            applyProductMatrix(matrix, expansion, product);
            size_t at = 0;
            for (int m = 0; m < cosineBands; ++m)
                for (int l = m; l < cosineBands; ++l) {
                    if (l > 1 && l % 2 == 1) continue;
                    const double scale = clampedCosineBand(l) * functionScale(l, m);
                    for (const int signedM : {m, -m}) {
                        products[at++ * vectors + vector][int(colour)] =
                            float(scale * double(product[size_t(shIndex(l, signedM))]));
                        if (m == 0) break;
                    }
                }
        }
    }
    return products;
}

TechniqueData::TechniqueData(const GlContext& context, Technique technique, const VisibilityMap& visibility)
    : context_(context), technique_(technique), shOrder_(visibility.shOrder) {
    PRT_CHECK(readsVisibility(technique));
    if (technique.kind == TechniqueKind::PreconvolvedAo) {
        shOrder_ = 1;
        upload(visibility.grid, 1, visibility.ao, "ambient occlusion");
        defines_ += "#define PRECONVOLVED\n";
        return;
    }
    if (technique.kind == TechniqueKind::Sh2) {
        PRT_CHECK_EQ(visibility.shOrder, 2);
        defines_ += "#define TWO_BANDS\n";
    }
    upload(visibility.grid, shCount(shOrder_), visibility.coefficients, "visibility");
}

TechniqueData::TechniqueData(const GlContext& context, Technique technique, const PcaMap& pca)
    : context_(context), technique_(technique), shOrder_(pca.shOrder) {
    PRT_CHECK(readsWeights(technique));
    upload(pca.grid, pca.components, pca.weights, "PCA weights");
    basis_.shOrder = pca.shOrder;
    basis_.components = pca.components;
    basis_.mean = pca.mean;
    basis_.basis = pca.basis;
    defines_ += usesTable(technique) ? "#define WITH_MEAN\n" : "#define UNIFORM_PRODUCTS\n";
}

TechniqueData::TechniqueData(const GlContext& context, Technique technique, const Lightmap& lightmap)
    : context_(context), technique_(technique), shOrder_(kLightmapShOrder) {
    PRT_CHECK(technique.kind == TechniqueKind::ShLightmap);
    defines_ += "#define LIGHTMAP\n";
    setLightmap(lightmap);
}

void TechniqueData::setLightmap(const Lightmap& lightmap) {
    PRT_CHECK(technique_.kind == TechniqueKind::ShLightmap);
    const std::vector<float> packed = packLightmap(lightmap);
    upload(lightmap.grid, kPackedLightmap, packed, "lightmap");
    chooseProgram("");
    ++lightRevision_;
}

void TechniqueData::upload(const PointGrid& grid, int perPoint, std::span<const float> values,
                           const char* where) {
    coefficients_ = uploadCoefficients(context_, grid, perPoint, values, where);
    perPoint_ = perPoint;
    perVertex_ = grid.domain == PointDomain::Vertex;
}

void TechniqueData::chooseProgram(const std::string& further) {
    const std::string defines = defines_ + (perVertex_ ? "#define PER_VERTEX\n" : "") + further;
    if (!programs_.contains(defines)) programs_.try_emplace(defines, context_.gl(), defines);
    program_ = &programs_.at(defines);
}

void TechniqueData::setTable(const NormalTable& table) {
    if (!usesTable(technique_) || table.kind != tableKindOf(technique_))
        throw InputError(techniqueName(technique_),
                         fmt::format("takes no {} table", tableKindName(table.kind)));
    const int layers =
        technique_.kind == TechniqueKind::PreconvolvedAo ? 1 : perPoint_ + (readsWeights(technique_) ? 1 : 0);
    if (table.shOrder != shOrder_ || table.layers != layers)
        throw InputError("table",
                         fmt::format("is of order {} with {} layers, the data needs order {} with {}",
                                     table.shOrder, table.layers, shOrder_, layers),
                         "make it anew with prt tabulate");
    setTable([&](TableImage& image) { uploadTable(context_, table, image); });
}

void TechniqueData::setTable(const std::function<void(TableImage&)>& fill) {
    PRT_CHECK(usesTable(technique_));
    fill(table_);
    chooseProgram(fmt::format("{}#define TABLE_LAYERS {}\n#define TABLE_SIZE {}\n",
                              layoutDefine(table_.shape.layout), table_.shape.layers, table_.shape.size));
    ++lightRevision_;
}

void TechniqueData::setLight(const EnvironmentSh& light, int cosineBands) {
    PRT_CHECK(!usesTable(technique_));
    if (technique_.kind == TechniqueKind::Sh2)
        setTwoBands(light);
    else
        setProducts(light, cosineBands);
    ++lightRevision_;
}

void TechniqueData::setProducts(const EnvironmentSh& light, int cosineBands) {
    const int functions = cosineFunctionCount(cosineBands);
    const int vectors = basis_.components + 1,
              limit = glInteger(context_.gl(), GL_MAX_FRAGMENT_UNIFORM_VECTORS);
    // The suns and the shader's own numbers have their uniforms too.
    constexpr int kOther = 32;
    if (functions * vectors + kOther > limit)
        throw InputError(techniqueName(technique_),
                         fmt::format("{} vectors and {} bands of the cosine make {} uniforms, more than the "
                                     "{} that OpenGL takes here",
                                     basis_.components, cosineBands, functions * vectors, limit - kOther),
                         "use pca, fewer vectors, or the paper's variant of the cosine");
    lightValues_ = uniformProducts(light, basis_, cosineBands);
    lightUniform_ = "products";
    chooseProgram(fmt::format("#define COSINE_BANDS {}\n#define COSINE_FUNCTIONS {}\n#define VECTORS {}\n",
                              cosineBands, functions, basis_.components));
}

void TechniqueData::setTwoBands(const EnvironmentSh& light) {
    PRT_CHECK_LE(2, light.shOrder);
    // L = constant + gradient·ω
    const float constant = std::sqrt(1 / (4 * std::numbers::pi_v<float>)),
                linear = std::sqrt(3 / (4 * std::numbers::pi_v<float>));
    lightUniform_ = "light";
    lightValues_.resize(4);
    for (size_t c = 0; c < 3; ++c) {
        const std::vector<float>& sh = light.rgb[c];
        const float values[4] = {constant * sh[0], -linear * sh[3], -linear * sh[1], linear * sh[2]};
        for (size_t i = 0; i < 4; ++i) lightValues_[i][int(c)] = values[i];
    }
    chooseProgram("");
}

void TechniqueData::checkLight() const {
    if (program_) return;
    const bool table = usesTable(technique_);
    throw InputError(techniqueName(technique_), table ? "no table was set" : "no light was set",
                     table ? "make one with prt tabulate" : "set an environment");
}

const GlProgram& TechniqueData::use(Pixels pixels) const {
    PRT_CHECK(program_ != nullptr);
    const GlProgram& program = program_->of(pixels);
    program.use();
    if (usesTable(technique_)) {
        context_.gl().BindTextureUnit(5, table_.texture.name());
    } else if (lightUniform_) {
        program.set(lightUniform_, lightValues_);
    }
    program.set("gridSize", coefficients_.grid.width, coefficients_.grid.height);
    context_.gl().BindTextureUnit(4, coefficients_.texture.name());
    return program;
}

}  // namespace prt
