// Noises of clouds and what lights them, from storage buffers: the processor's own numbers, looked
// up as model/cloud_density_kernels.py and model/cloud_march_kernels.py do. Cards keep few bits of a
// place between texels when they filter textures.

layout(std430, binding = 1) restrict readonly buffer CloudNoises { float noise_texels[]; };
layout(std430, binding = 2) restrict readonly buffer CloudDepths { float volume_depths[]; };
layout(std430, binding = 3) restrict readonly buffer CloudDiffuse { vec4 volume_diffuse[]; };
layout(std430, binding = 4) restrict readonly buffer CloudTransport { vec4 transport[]; };
// The phase function, three rows of its nodes, and the sun at base and top: three numbers each.
layout(std430, binding = 5) restrict readonly buffer CloudTables { float tables[]; };

const int LEVELS = 12;
// Where levels of weather, shape and detail begin, and their edges.
uniform int noise_levels[6 * LEVELS];
uniform vec3 noise_last;
uniform ivec2 volume_shape;     // columns of a side, edges between heights
uniform ivec2 table_nodes;      // of the phase function, of the sun's heights

// Weather is one within a sample.
const float EVEN = 5e-3;

int start_of(int kind, int level) { return noise_levels[2 * (LEVELS * kind + level)]; }
int edge_of(int kind, int level) { return noise_levels[2 * (LEVELS * kind + level) + 1]; }

float weather_edge() { return float(edge_of(0, 0)); }
float shape_edge() { return float(edge_of(1, 0)); }
float detail_edge() { return float(edge_of(2, 0)); }

// The two of n periodic texels beside a place, in periods.
ivec2 neighbours(float at, int n, out float share) {
    float place = (at - floor(at)) * float(n) - 0.5, low = floor(place);
    int i = int(low);
    share = place - low;
    return ivec2(i >= 0 ? i : n - 1, i + 1 < n ? i + 1 : 0);
}

float flat_level(int level, vec2 at) {
    int start = start_of(0, level), n = edge_of(0, level);
    float s, t;
    ivec2 i = neighbours(at.x, n, s), j = start + n * neighbours(at.y, n, t);
    return mix(mix(noise_texels[j.x + i.x], noise_texels[j.x + i.y], s),
               mix(noise_texels[j.y + i.x], noise_texels[j.y + i.y], s), t);
}

float deep_level(int kind, int level, vec3 at) {
    int start = start_of(kind, level), n = edge_of(kind, level);
    float s, t, r;
    ivec2 i = neighbours(at.x, n, s), j = n * neighbours(at.y, n, t);
    ivec2 k = start + n * n * neighbours(at.z, n, r);
    ivec4 row = ivec4(k.x + j.x, k.x + j.y, k.y + j.x, k.y + j.y);
    vec4 along = vec4(mix(noise_texels[row.x + i.x], noise_texels[row.x + i.y], s),
                      mix(noise_texels[row.y + i.x], noise_texels[row.y + i.y], s),
                      mix(noise_texels[row.z + i.x], noise_texels[row.z + i.y], s),
                      mix(noise_texels[row.w + i.x], noise_texels[row.w + i.y], s));
    return mix(mix(along.x, along.y, t), mix(along.z, along.w, t), r);
}

float weather_at(vec2 at, float lod) {
    lod = clamp(lod, 0.0, noise_last.x);
    int level = int(lod);
    float value = flat_level(level, at), share = lod - float(level);
    return share > 0.0 ? mix(value, flat_level(level + 1, at), share) : value;
}

float noise_at(int kind, vec3 at, float lod) {
    lod = clamp(lod, 0.0, noise_last[kind]);
    int level = int(lod);
    float value = deep_level(kind, level, at), share = lod - float(level);
    return share > 0.0 ? mix(value, deep_level(kind, level + 1, at), share) : value;
}

float shape_at(vec3 at, float lod) { return noise_at(1, at, lod); }
float detail_at(vec3 at, float lod) { return noise_at(2, at, lod); }

// Weather within a sample less its mean, in even steps over half its range.
vec4 weather_steps(float half_range) {
    return half_range < EVEN ? vec4(-half_range)
                             : half_range * vec4(-1.0, -1.0 / 3.0, 1.0 / 3.0, 1.0);
}

float volume_edges() { return float(volume_shape.y); }

// Indices of the eight cells of the volume around a place in [0, 1], and shares of the second of
// each pair.
void cells_around(vec3 place, out ivec4 low, out ivec4 high, out vec3 share) {
    ivec3 shape = volume_shape.xxy;
    vec3 at = clamp(place * vec3(shape) - 0.5, vec3(0.0), vec3(shape - 1));
    ivec3 first = min(ivec3(at), shape - 2);
    share = at - vec3(first);
    int cell = (first.z * shape.y + first.y) * shape.x + first.x;
    low = cell + ivec4(0, 1, shape.x, shape.x + 1);
    high = low + shape.x * shape.y;
}

vec3 depths_in(int cell) {
    return vec3(volume_depths[3 * cell], volume_depths[3 * cell + 1], volume_depths[3 * cell + 2]);
}

vec3 depths_at(vec3 place) {
    ivec4 low, high;
    vec3 share;
    cells_around(place, low, high, share);
    vec3 near = mix(mix(depths_in(low.x), depths_in(low.y), share.x),
                    mix(depths_in(low.z), depths_in(low.w), share.x), share.y);
    vec3 far = mix(mix(depths_in(high.x), depths_in(high.y), share.x),
                   mix(depths_in(high.z), depths_in(high.w), share.x), share.y);
    return mix(near, far, share.z);
}

vec4 diffuse_at(vec3 place) {
    ivec4 low, high;
    vec3 share;
    cells_around(place, low, high, share);
    vec4 near = mix(mix(volume_diffuse[low.x], volume_diffuse[low.y], share.x),
                    mix(volume_diffuse[low.z], volume_diffuse[low.w], share.x), share.y);
    vec4 far = mix(mix(volume_diffuse[high.x], volume_diffuse[high.y], share.x),
                   mix(volume_diffuse[high.z], volume_diffuse[high.w], share.x), share.y);
    return mix(near, far, share.z);
}

vec4 transport_row(ivec2 at, float view, int views) {
    int v = min(int(view), views - 2), row = (at.y * TRANSPORT_DEPTHS + at.x) * views + v;
    return mix(transport[row], transport[row + 1], view - float(v));
}

// Nodes of views, of depths above, and of depths below the one after the other for each sine.
vec4 transport_nodes(vec3 node) {
    ivec2 low = ivec2(min(int(node.y), TRANSPORT_DEPTHS - 2), int(node.z));
    // The last depth below is no first of a pair: that would be the next sine's.
    if (low.y % TRANSPORT_DEPTHS == TRANSPORT_DEPTHS - 1) --low.y;
    vec2 share = node.yz - vec2(low);
    vec4 near = mix(transport_row(low, node.x, TRANSPORT_VIEWS),
                    transport_row(low + ivec2(1, 0), node.x, TRANSPORT_VIEWS), share.x);
    vec4 far = mix(transport_row(low + ivec2(0, 1), node.x, TRANSPORT_VIEWS),
                   transport_row(low + ivec2(1, 1), node.x, TRANSPORT_VIEWS), share.x);
    return mix(near, far, share.y);
}

vec3 table_at(int node) {
    return vec3(tables[3 * node], tables[3 * node + 1], tables[3 * node + 2]);
}

vec3 table_between(int start, float node, int nodes) {
    int i = min(int(node), nodes - 2);
    return mix(table_at(start + i), table_at(start + i + 1), node - float(i));
}

float phase_angles() { return float(table_nodes.x); }
vec3 phase_nodes(float node, int row) {
    return table_between(row * table_nodes.x, node, table_nodes.x);
}

vec3 sun_nodes(float share, float height) {
    float node = share * float(table_nodes.y - 1);
    int base = 3 * table_nodes.x;
    return mix(table_between(base, node, table_nodes.y),
               table_between(base + table_nodes.y, node, table_nodes.y), height);
}
