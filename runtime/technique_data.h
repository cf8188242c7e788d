// What one technique draws with: textures, uniforms and shaders. Internal.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "precompute/io/lightmap_file.h"
#include "precompute/io/table_file.h"
#include "precompute/io/visibility_file.h"
#include "precompute/math/environment.h"
#include "runtime/coefficient_images.h"
#include "runtime/gl_context.h"
#include "runtime/gl_objects.h"
#include "runtime/light_program.h"
#include "runtime/technique.h"

namespace prt {

/// Coefficients of the points, and the light as the technique takes it. Needs the context to be current.
class TechniqueData {
  public:
    /// For a technique that reads visibility: Unc draws all bands of the map, Sh2 needs two, PreconvolvedAo
    /// takes the ambient occlusion.
    /// @throws InputError  larger than OpenGL takes
    TechniqueData(const GlContext& context, Technique technique, const VisibilityMap& visibility);
    /// For a technique that reads weights: all vectors of the map.
    /// @throws InputError  larger than OpenGL takes
    TechniqueData(const GlContext& context, Technique technique, const PcaMap& pca);

    /// For ShLightmap, whose light is in its data.
    /// @throws InputError  larger than OpenGL takes
    TechniqueData(const GlContext& context, Technique technique, const Lightmap& lightmap);

    /// Another lightmap in place of the one before.
    /// @throws InputError  larger than OpenGL takes
    void setLightmap(const Lightmap& lightmap);
    /// Light of a technique that looks it up by the normal.
    /// @throws InputError  kind, order or number of layers is not what the coefficients need
    void setTable(const NormalTable& table);
    /// The same by a function that fills the table's image, with what fits the coefficients.
    void setTable(const std::function<void(TableImage&)>& fill);
    /// The table in use; no texture before one was set.
    const TableImage& table() const { return table_; }
    /// Light of a technique that evaluates it at every pixel: Sh2 takes two bands of it, PcaUniform
    /// shOrder() + cosineBands − 1.
    /// @throws InputError  more uniforms than OpenGL takes
    void setLight(const EnvironmentSh& light, int cosineBands);

    /// @throws InputError  no light was set
    void checkLight() const;
    /// Of light.frag, once there is light.
    const std::string& defines() const { return program_->defines(); }
    /// Tables, uniforms or lightmaps that were set so far.
    uint64_t lightRevision() const { return lightRevision_; }
    int shOrder() const { return shOrder_; }
    /// Vectors that weights belong to, without the weights; empty for techniques that read visibility.
    const PcaMap& basis() const { return basis_; }

    /// Uses the program, with uniforms of the technique set and its textures bound to units 4 and 5.
    const GlProgram& use(Pixels pixels) const;

  private:
    void upload(const PointGrid& grid, int perPoint, std::span<const float> values, const char* where);
    void chooseProgram(const std::string& further);
    void setProducts(const EnvironmentSh& light, int cosineBands);
    void setTwoBands(const EnvironmentSh& light);

    const GlContext& context_;
    Technique technique_;
    CoefficientImage coefficients_;
    TableImage table_;
    int shOrder_ = 0, perPoint_ = 0;
    PcaMap basis_;         // without weights
    std::string defines_;  // of the technique
    bool perVertex_ = false;
    std::map<std::string, LightProgram> programs_;  // by their defines
    const LightProgram* program_ = nullptr;         // that of the light
    const char* lightUniform_ = nullptr;            // light that is no table: its array in the program
    std::vector<Vec3f> lightValues_;
    uint64_t lightRevision_ = 0;
};

/// Whether the technique looks light up by the normal; else its light is uniforms, or a lightmap.
bool usesTable(Technique technique);
/// Kind of that table.
TableKind tableKindOf(Technique technique);

/// Product of every vector and the light, convolved with the clamped cosine, for the recurrence of
/// runtime/shaders/light.frag: irradiance is Σ_j f_j(n) Σ_m w_m P_jm, w 1 for the mean, over functions f_j =
/// z-polynomial × cos or sin of mφ.
/// @param light  of shOrder + cosineBands − 1 bands or more
/// @return [cosineFunctionCount(cosineBands)×(M + 1)], the mean last
/// @source [IwanickiSloan2012, Sec. 4, alternative]
std::vector<Vec3f> uniformProducts(const EnvironmentSh& light, const PcaMap& basis, int cosineBands);

}  // namespace prt
