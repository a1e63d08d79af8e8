// Air in front of any surface, or the small table for near surfaces.
#ifdef NEAR_AIR
//!include near_air.glsl
#else
//!include air.glsl
#endif
