// The position of a direction in an equirectangular environment map.
#ifndef COMMON_SKY_PLACE_GLSL
#define COMMON_SKY_PLACE_GLSL

// w is a unit vector. Returns 0…1 from left to right and 0…1 from top to bottom. `turn` rotates the map about +Y, in
// revolutions, 0…1.
vec2 sky_place(vec3 w, float turn)
{
	float across = length(w.xz);
	float longitude = across > 0.0 ? atan(w.x, -w.z) : 0.0;
	float u = 0.5 + longitude * 0.15915494309189535 + turn;
	return vec2(u - floor(u), atan(across, w.y) * 0.31830988618379067);
}

#endif
