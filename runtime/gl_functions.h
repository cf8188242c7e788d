// The OpenGL 4.5 functions that the runtime calls, filled through whatever resolves names for the context at
// hand. Internal: no other header shows OpenGL types.
#pragma once

// osmesa.h and others bring gl.h, whose version macros would keep the prototypes away.
#undef GL_VERSION_1_0
#undef GL_VERSION_1_1
#undef GL_VERSION_1_2
#undef GL_VERSION_1_3
#include <GL/glcorearb.h>

#include <functional>

#include "runtime/gl_context.h"

// X(type in glcorearb.h, name without "gl")
#define PRT_GL_FUNCTIONS(X)                                              \
    X(PFNGLACTIVETEXTUREPROC, ActiveTexture)                             \
    X(PFNGLATTACHSHADERPROC, AttachShader)                               \
    X(PFNGLBINDBUFFERPROC, BindBuffer)                                   \
    X(PFNGLBINDFRAMEBUFFERPROC, BindFramebuffer)                         \
    X(PFNGLBINDSAMPLERPROC, BindSampler)                                 \
    X(PFNGLBINDTEXTUREPROC, BindTexture)                                 \
    X(PFNGLBINDTEXTUREUNITPROC, BindTextureUnit)                         \
    X(PFNGLBINDVERTEXARRAYPROC, BindVertexArray)                         \
    X(PFNGLCHECKNAMEDFRAMEBUFFERSTATUSPROC, CheckNamedFramebufferStatus) \
    X(PFNGLCLEARNAMEDFRAMEBUFFERFVPROC, ClearNamedFramebufferfv)         \
    X(PFNGLCLEARNAMEDFRAMEBUFFERUIVPROC, ClearNamedFramebufferuiv)       \
    X(PFNGLCLIPCONTROLPROC, ClipControl)                                 \
    X(PFNGLCOLORMASKIPROC, ColorMaski)                                   \
    X(PFNGLCOMPILESHADERPROC, CompileShader)                             \
    X(PFNGLCREATEBUFFERSPROC, CreateBuffers)                             \
    X(PFNGLCREATEFRAMEBUFFERSPROC, CreateFramebuffers)                   \
    X(PFNGLCREATEPROGRAMPROC, CreateProgram)                             \
    X(PFNGLCREATESAMPLERSPROC, CreateSamplers)                           \
    X(PFNGLCREATESHADERPROC, CreateShader)                               \
    X(PFNGLCREATETEXTURESPROC, CreateTextures)                           \
    X(PFNGLCREATEVERTEXARRAYSPROC, CreateVertexArrays)                   \
    X(PFNGLCULLFACEPROC, CullFace)                                       \
    X(PFNGLDEBUGMESSAGECALLBACKPROC, DebugMessageCallback)               \
    X(PFNGLDELETEBUFFERSPROC, DeleteBuffers)                             \
    X(PFNGLDELETEFRAMEBUFFERSPROC, DeleteFramebuffers)                   \
    X(PFNGLDELETEPROGRAMPROC, DeleteProgram)                             \
    X(PFNGLDELETESAMPLERSPROC, DeleteSamplers)                           \
    X(PFNGLDELETESHADERPROC, DeleteShader)                               \
    X(PFNGLDELETETEXTURESPROC, DeleteTextures)                           \
    X(PFNGLDELETEVERTEXARRAYSPROC, DeleteVertexArrays)                   \
    X(PFNGLDEPTHFUNCPROC, DepthFunc)                                     \
    X(PFNGLDEPTHMASKPROC, DepthMask)                                     \
    X(PFNGLDEPTHRANGEINDEXEDPROC, DepthRangeIndexed)                     \
    X(PFNGLDISABLEPROC, Disable)                                         \
    X(PFNGLDISABLEIPROC, Disablei)                                       \
    X(PFNGLDRAWARRAYSPROC, DrawArrays)                                   \
    X(PFNGLDRAWARRAYSINSTANCEDPROC, DrawArraysInstanced)                 \
    X(PFNGLENABLEPROC, Enable)                                           \
    X(PFNGLENABLEIPROC, Enablei)                                         \
    X(PFNGLFINISHPROC, Finish)                                           \
    X(PFNGLFRONTFACEPROC, FrontFace)                                     \
    X(PFNGLGENERATETEXTUREMIPMAPPROC, GenerateTextureMipmap)             \
    X(PFNGLGETBOOLEANI_VPROC, GetBooleani_v)                             \
    X(PFNGLGETBOOLEANVPROC, GetBooleanv)                                 \
    X(PFNGLGETDOUBLEI_VPROC, GetDoublei_v)                               \
    X(PFNGLGETERRORPROC, GetError)                                       \
    X(PFNGLGETFLOATI_VPROC, GetFloati_v)                                 \
    X(PFNGLGETFLOATVPROC, GetFloatv)                                     \
    X(PFNGLGETGRAPHICSRESETSTATUSPROC, GetGraphicsResetStatus)           \
    X(PFNGLGETINTEGERVPROC, GetIntegerv)                                 \
    X(PFNGLGETPROGRAMINFOLOGPROC, GetProgramInfoLog)                     \
    X(PFNGLGETPROGRAMIVPROC, GetProgramiv)                               \
    X(PFNGLGETSHADERINFOLOGPROC, GetShaderInfoLog)                       \
    X(PFNGLGETSHADERIVPROC, GetShaderiv)                                 \
    X(PFNGLGETSTRINGPROC, GetString)                                     \
    X(PFNGLGETSTRINGIPROC, GetStringi)                                   \
    X(PFNGLGETTEXTUREIMAGEPROC, GetTextureImage)                         \
    X(PFNGLGETUNIFORMLOCATIONPROC, GetUniformLocation)                   \
    X(PFNGLISENABLEDPROC, IsEnabled)                                     \
    X(PFNGLISENABLEDIPROC, IsEnabledi)                                   \
    X(PFNGLLINKPROGRAMPROC, LinkProgram)                                 \
    X(PFNGLNAMEDBUFFERSTORAGEPROC, NamedBufferStorage)                   \
    X(PFNGLNAMEDFRAMEBUFFERDRAWBUFFERSPROC, NamedFramebufferDrawBuffers) \
    X(PFNGLNAMEDFRAMEBUFFERTEXTUREPROC, NamedFramebufferTexture)         \
    X(PFNGLPIXELSTOREIPROC, PixelStorei)                                 \
    X(PFNGLPOLYGONMODEPROC, PolygonMode)                                 \
    X(PFNGLPROGRAMUNIFORM1FPROC, ProgramUniform1f)                       \
    X(PFNGLPROGRAMUNIFORM1FVPROC, ProgramUniform1fv)                     \
    X(PFNGLPROGRAMUNIFORM1IPROC, ProgramUniform1i)                       \
    X(PFNGLPROGRAMUNIFORM2IPROC, ProgramUniform2i)                       \
    X(PFNGLPROGRAMUNIFORM3FVPROC, ProgramUniform3fv)                     \
    X(PFNGLPROGRAMUNIFORMMATRIX4FVPROC, ProgramUniformMatrix4fv)         \
    X(PFNGLPROVOKINGVERTEXPROC, ProvokingVertex)                         \
    X(PFNGLSAMPLERPARAMETERFPROC, SamplerParameterf)                     \
    X(PFNGLSAMPLERPARAMETERIPROC, SamplerParameteri)                     \
    X(PFNGLSHADERSOURCEPROC, ShaderSource)                               \
    X(PFNGLTEXTUREBUFFERPROC, TextureBuffer)                             \
    X(PFNGLTEXTUREPARAMETERIPROC, TextureParameteri)                     \
    X(PFNGLTEXTURESTORAGE2DPROC, TextureStorage2D)                       \
    X(PFNGLTEXTURESTORAGE2DMULTISAMPLEPROC, TextureStorage2DMultisample) \
    X(PFNGLTEXTURESTORAGE3DPROC, TextureStorage3D)                       \
    X(PFNGLTEXTURESUBIMAGE2DPROC, TextureSubImage2D)                     \
    X(PFNGLTEXTURESUBIMAGE3DPROC, TextureSubImage3D)                     \
    X(PFNGLUSEPROGRAMPROC, UseProgram)                                   \
    X(PFNGLVIEWPORTPROC, Viewport)                                       \
    X(PFNGLVIEWPORTINDEXEDFVPROC, ViewportIndexedfv)

namespace prt {

/// One member per function: `gl.DrawArrays(…)`.
struct GlFunctions {
#define PRT_GL_MEMBER(type, name) type name = nullptr;
    PRT_GL_FUNCTIONS(PRT_GL_MEMBER)
#undef PRT_GL_MEMBER
};

/// Fills the table.
/// @param getProc  resolves "glDrawArrays" and the like; null for a name it does not know
/// @throws InputError  a name was not resolved
GlFunctions loadGlFunctions(const std::function<GlProc(const char* name)>& getProc);

}  // namespace prt
