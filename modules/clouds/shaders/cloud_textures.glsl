// The noises of clouds as textures, whose filters average them over a sample's width.

layout(binding = 0) uniform sampler2D cloud_weather;
layout(binding = 1) uniform sampler3D cloud_shape;
layout(binding = 2) uniform sampler3D cloud_detail;

float weather_edge() { return float(textureSize(cloud_weather, 0).x); }
float shape_edge() { return float(textureSize(cloud_shape, 0).x); }
float detail_edge() { return float(textureSize(cloud_detail, 0).x); }

float weather_at(vec2 at, float lod) { return textureLod(cloud_weather, at, lod).r; }
float shape_at(vec3 at, float lod) { return textureLod(cloud_shape, at, lod).r; }
float detail_at(vec3 at, float lod) { return textureLod(cloud_detail, at, lod).r; }

// Weather within a sample less its mean, in even steps over half its range.
vec4 weather_steps(float half_range) { return half_range * vec4(-1.0, -1.0 / 3.0, 1.0 / 3.0, 1.0); }
