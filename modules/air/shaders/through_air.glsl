// All of the air, or the small table of what is near.
#ifdef NEAR_AIR
//!include near_air.glsl
#else
//!include air.glsl
#endif
