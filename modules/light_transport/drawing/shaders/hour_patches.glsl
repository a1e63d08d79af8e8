// The surfaces of patches; see `CardTables.patches`.

layout(std430, binding = 3) readonly buffer Patches { vec4 patches[]; };
uniform vec3 ground_albedo;

vec3 reflectance_of(uint patch_number) {
    bool on_ground = patches[3u * patch_number].w > 0.0;
    return on_ground ? ground_albedo : patches[3u * patch_number + 1u].rgb;
}
