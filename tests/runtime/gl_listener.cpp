// For every test of this program: contexts are debug contexts, no OpenGL object outlives its test, and no
// message of the driver goes unread.
#include <cstdlib>

#include "runtime/gl_debug.h"
#include "runtime/gl_objects.h"

namespace prt {
namespace {

class GlListener : public testing::EmptyTestEventListener {
    void OnTestStart(const testing::TestInfo&) override {
        objects_ = liveGlObjects();
        messages_ = GlMessages::unreported();
    }
    void OnTestEnd(const testing::TestInfo&) override {
        EXPECT_EQ(liveGlObjects(), objects_) << "OpenGL objects are left";
        EXPECT_EQ(GlMessages::unreported(), messages_) << "errors of OpenGL that nobody asked for";
    }
    size_t objects_ = 0, messages_ = 0;
};

const bool kInstalled = [] {
    ::setenv("PRT_GL_DEBUG", "1", 0);
    testing::UnitTest::GetInstance()->listeners().Append(new GlListener);
    return true;
}();

}  // namespace
}  // namespace prt
