// The ways of lighting a surface by precomputed visibility: their names, what each needs, what each costs.
// This is the one list of them; help, errors and comparisons are made from it.
#pragma once

#include <compare>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "precompute/base/error.h"
#include "precompute/io/visibility_file.h"

namespace prt {

enum class TechniqueKind {
    Unc,            ///< coefficients of visibility · light × cosine table
    Pca,            ///< weights · light × cosine × vector tables
    VertexPca,      ///< Pca with weights at the vertices, also where the bundle is per texel
    PcaUniform,     ///< weights · products of vectors and light, convolved with the cosine at every pixel
    ShLightmap,     ///< radiance that arrives at the point, with its bounces, baked for one light
    Sh2,            ///< visibility and light of two bands, multiplied and convolved at every pixel
    PreconvolvedAo  ///< table of unoccluded irradiance × ambient occlusion
};

/// @source [IwanickiSloan2012, Sec. 3 to 5]
struct Technique {
    TechniqueKind kind = TechniqueKind::Unc;
    /// Unc: bands of visibility, 1..kMaxBundleShOrder; Pca and VertexPca: leading vectors, 1..n². 0: all that
    /// there are.
    /// Always 0 for the others.
    int number = 0;

    static const Technique Unc, Pca, VertexPca, PcaUniform, ShLightmap, Sh2, PreconvolvedAo;
    std::strong_ordering operator<=>(const Technique&) const = default;
};
inline constexpr Technique Technique::Unc{TechniqueKind::Unc, 0};
inline constexpr Technique Technique::Pca{TechniqueKind::Pca, 0};
inline constexpr Technique Technique::VertexPca{TechniqueKind::VertexPca, 0};
inline constexpr Technique Technique::PcaUniform{TechniqueKind::PcaUniform, 0};
inline constexpr Technique Technique::ShLightmap{TechniqueKind::ShLightmap, 0};
inline constexpr Technique Technique::Sh2{TechniqueKind::Sh2, 0};
inline constexpr Technique Technique::PreconvolvedAo{TechniqueKind::PreconvolvedAo, 0};

/// "unc", "unc6", "pca", "pca16", "vertex-pca", "pca-uniform", "sh-lightmap", "sh2", "preconvolved-ao".
std::string techniqueName(Technique technique);
/// Inverse of techniqueName, for every number in its range.
/// @return nothing where no technique has that name
std::optional<Technique> techniqueFromName(std::string_view name);
/// What the technique computes, in a few words.
std::string techniqueSummary(Technique technique);

/// Techniques of the paper's table in the order in which they are listed: unc, unc3, unc4, unc6, pca, pca4,
/// pca8, … pca24, vertex-pca, pca-uniform, sh-lightmap, sh2, preconvolved-ao.
const std::vector<Technique>& listedTechniques();
/// Their names, joined by commas.
std::string listedTechniqueNames();

/// What a bundle holds. Sizes of what is missing are 0.
struct TechniqueSource {
    int shOrder = 0;         ///< bands of visibility.exr
    int pcaShOrder = 0;      ///< bands of the vectors of pca.exr
    int components = 0;      ///< vectors of pca.exr
    bool lightmaps = false;  ///< of all environments that are asked for
};
/// Whether a technique reads coefficients, or ambient occlusion, of visibility.exr.
bool readsVisibility(Technique technique);
/// Whether it reads pca.exr.
bool readsWeights(Technique technique);
/// That what a technique reads is missing: what it is, and which command makes it.
InputError missingData(Technique technique);
/// @throws InputError  what the technique needs is missing, or has fewer bands or vectors: says how to make
/// it
void checkTechnique(Technique technique, const TechniqueSource& source);
/// Whether checkTechnique would pass.
bool canDraw(Technique technique, const TechniqueSource& source);

/// Work of runtime/shaders/light.frag for one pixel, without the surface (normal, albedo, place) and suns.
struct TechniqueCost {
    int fetches = 0;       ///< of four channels, filtered or not
    int multiplyAdds = 0;  ///< of scalars, at a rounding: what the formula needs
    int uniforms = 0;      ///< of three floats, that change with the light
};
/// With L = ⌈values/4⌉ layers of coefficients:
///   unc              4L fetches, 12L multiply-adds
///   pca              one fetch more, for the mean
///   vertex-pca       as pca, per vertex
///   pca-uniform      L fetches, F·(12L + 6) multiply-adds, F·(M + 1) uniforms; F functions of the cosine
///   sh-lightmap      7 fetches, 45 multiply-adds
///   sh2              1 fetch, 45 multiply-adds, 4 uniforms
///   preconvolved-ao  2 fetches, 3 multiply-adds
/// Per vertex each layer of coefficients is fetched at three corners and mixed: 2L fetches and 12L
/// multiply-adds more.
/// @param source       of which checkTechnique(technique, source) passes
/// @param cosineBands  of the tables (TableOptions::cosineBands)
/// @source [IwanickiSloan2012, Sec. 3.2, 4 and 5]
TechniqueCost techniqueCost(Technique technique, const TechniqueSource& source, PointDomain domain,
                            int cosineBands);

/// Spherical harmonics of so many bands whose coefficients in a clamped cosine are not zero: bands 0, 1 and
/// the even ones.
/// @param bands  1..kMaxShOrder
/// @source [RamamoorthiHanrahan2001, Eq. 19]
int cosineFunctionCount(int bands);

}  // namespace prt
