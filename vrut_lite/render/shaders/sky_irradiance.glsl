// Irradiance under the open sky.

uniform vec3 irradiance_sh[25];

// E(n) = sum c_i Y_i(n), bands 0 to 4: the twin of geometry/spherical_harmonics.py.
vec3 sky_irradiance(vec3 n) {
    float x = n.x, y = n.y, z = n.z, x2 = x * x, y2 = y * y, z2 = z * z;
    vec3 e = irradiance_sh[0] * 0.28209479177387814;
    e += 0.4886025119029199 * (irradiance_sh[1] * y + irradiance_sh[2] * z + irradiance_sh[3] * x);
    e += 1.0925484305920792 * (irradiance_sh[4] * x * y + irradiance_sh[5] * y * z
                               + irradiance_sh[7] * x * z);
    e += irradiance_sh[6] * (0.31539156525252005 * (3.0 * z2 - 1.0));
    e += irradiance_sh[8] * (0.5462742152960396 * (x2 - y2));
    e += 0.5900435899266435 * (irradiance_sh[9] * y * (3.0 * x2 - y2)
                               + irradiance_sh[15] * x * (x2 - 3.0 * y2));
    e += irradiance_sh[10] * (2.890611442640554 * x * y * z);
    e += 0.4570457994644658 * (5.0 * z2 - 1.0) * (irradiance_sh[11] * y + irradiance_sh[13] * x);
    e += irradiance_sh[12] * (0.3731763325901154 * z * (5.0 * z2 - 3.0));
    e += irradiance_sh[14] * (1.445305721320277 * z * (x2 - y2));
    e += irradiance_sh[16] * (2.5033429417967046 * x * y * (x2 - y2));
    e += 1.7701307697799304 * (irradiance_sh[17] * y * z * (3.0 * x2 - y2)
                               + irradiance_sh[23] * x * z * (x2 - 3.0 * y2));
    e += irradiance_sh[18] * (0.9461746957575601 * x * y * (7.0 * z2 - 1.0));
    e += 0.6690465435572892 * z * (7.0 * z2 - 3.0) * (irradiance_sh[19] * y + irradiance_sh[21] * x);
    e += irradiance_sh[20] * (0.10578554691520431 * (35.0 * z2 * z2 - 30.0 * z2 + 3.0));
    e += irradiance_sh[22] * (0.47308734787878004 * (x2 - y2) * (7.0 * z2 - 1.0));
    e += irradiance_sh[24] * (0.6258357354491761 * (x2 * (x2 - 3.0 * y2) - y2 * (3.0 * x2 - y2)));
    return max(e, 0.0);
}
