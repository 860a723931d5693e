// Fragments that run in vectors: what they need stands before anything else.
#if SLV_VECTORS
#extension GL_ARB_shader_ballot : require
#endif
