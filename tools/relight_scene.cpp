#include "tools/relight_scene.h"

#include "precompute/base/check.h"
#include "tools/background.h"

namespace prt::tools {

RelightScene::RelightScene(const RelightArguments& arguments)
    : arguments_(arguments),
      data_(loadRelightData(arguments)),
      techniques_(arguments, data_),
      suns_(data_.bundle, data_.scene, data_.environments),
      options_{arguments.width, arguments.height, !arguments.noNormalMap, arguments.samples},
      bounds_(sceneBounds(data_.scene)),
      context_(arguments.context.kind()),
      renderer_(context_, data_.scene, nullptr, nullptr) {
    techniques_.addTo(renderer_);
}

size_t RelightScene::setLight(const RelightLight& light) {
    if (light_ == light) return sunCount_;
    if (!arguments_.noBackground && !arguments_.output.empty()) {
        if (!light_ || light_->weights != light.weights)
            background_ = blendImages(data_.environments, light.weights);
        renderer_.setBackground(background_, light.rotationRad);
    }
    if (arguments_.tables.extractSun && !data_.techniques.empty())
        sunCount_ = suns_.setTo(renderer_, light.weights, light.rotationRad);
    light_ = light;
    return sunCount_;
}

RenderedFrame RelightScene::render(Technique technique, const Camera& camera, const char** origin) {
    PRT_CHECK(light_.has_value());
    const char* from = techniques_.setLight(renderer_, technique, light_->weights, light_->rotationRad);
    if (origin) *origin = from;
    return renderer_.render(camera, techniques_.drawn(technique), options_);
}

ByteImage RelightScene::picture(Technique technique, const Camera& camera, const FloatImage& radiance,
                                double exposureStops) {
    if (options_.samples == 1) return toDisplay(radiance, exposureStops, arguments_.toneCurve);
    const ByteImage rgba = renderer_.picture(camera, techniques_.drawn(technique), options_,
                                             {exposureStops, arguments_.toneCurve});
    ByteImage rgb{rgba.width, rgba.height, 3, {}};
    for (size_t i = 0; i < rgba.pixels.size(); ++i)
        if (i % 4 != 3) rgb.pixels.push_back(rgba.pixels[i]);
    return rgb;
}

SurfaceImage RelightScene::surface(const Camera& camera) {
    RenderOptions centres = options_;
    centres.samples = 1;
    return renderer_.surface(camera, centres);
}

}  // namespace prt::tools
