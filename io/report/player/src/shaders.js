// A sphere is a square that faces the eye: each of its points is cut with the sphere behind it.

/** Places the corners of the square so that it covers the sphere as it is seen. */
export const vertex = `
uniform mat3 edges;
uniform highp usampler2D places;
uniform highp sampler2D radii;
uniform highp isampler2D axes;
uniform float capped;
uniform float share;
varying vec3 axis;
varying vec3 centre;
varying vec3 point;
varying float size;
varying float index;

const vec2 corners[6] = vec2[6](
  vec2(-1, -1), vec2(1, -1), vec2(1, 1), vec2(-1, -1), vec2(1, 1), vec2(-1, 1)
);

void main() {
  int particle = gl_VertexID / 6;
  ivec2 listed = ivec2(particle % 1024, particle / 1024);
  vec4 place = vec4(texelFetch(places, listed, 0));
  vec2 corner = corners[gl_VertexID % 6];
  size = share * texelFetch(radii, listed, 0).r;
  index = place.w;
  axis = capped * (modelViewMatrix * vec4(vec3(texelFetch(axes, listed, 0).xyz) / 127.0, 0.0)).xyz;
  centre = (modelViewMatrix * vec4(edges * ((place.xyz + 0.5) / 65536.0), 1.0)).xyz;
  vec3 away = isOrthographic ? vec3(0.0, 0.0, -1.0) : normalize(centre);
  vec3 right = normalize(cross(away, vec3(0.0, 1.0, 0.0)));
  float far = length(centre);
  float wide = isOrthographic ? size : size * far / sqrt(max(far * far - size * size, 1e-6 * far * far));
  // A little more than the sphere, for the pixels that it covers in part.
  point = centre + 1.05 * wide * (corner.x * right + corner.y * cross(right, away));
  gl_Position = projectionMatrix * vec4(point, 1.0);
}
`;

/** Lights the sphere from above the eye's left; what is far is paler. */
export const fragment = `
uniform mat4 projectionMatrix;
uniform sampler2D palette;
uniform vec2 haze;
varying vec3 axis;
varying vec3 centre;
varying vec3 point;
varying float size;
varying float index;

void main() {
  vec3 ray = isOrthographic ? vec3(0.0, 0.0, -1.0) : normalize(point);
  vec3 start = isOrthographic ? vec3(point.xy, 0.0) : vec3(0.0);
  float middle = dot(centre - start, ray);
  vec3 off = start + middle * ray - centre;
  float inside = size * size - dot(off, off);
  float covered = inside / fwidth(inside) + 0.5;
  if (covered <= 0.0) discard;
  vec3 hit = start + (middle - sqrt(max(inside, 0.0))) * ray;
  vec3 normal = (hit - centre) / size;
  vec3 light = normalize(vec3(-0.5, 0.7, 0.8));
  float facing = -dot(normal, ray);
  float bright = (0.5 + 0.55 * max(dot(normal, light), 0.0)) * smoothstep(-0.35, 0.45, facing);
  float gleam = 0.22 * pow(max(dot(reflect(-light, normal), -ray), 0.0), 24.0);
  vec3 own = texture2D(palette, vec2((index + 0.5) / 256.0, 0.5)).rgb;
  // A dark cap where the axis leaves the sphere; without an axis there is none.
  float cap = smoothstep(0.76, 0.8, dot(normal, axis));
  vec3 colour = mix(own, vec3(0.1), cap) * bright + gleam;
  float pale = 0.5 * smoothstep(haze.x, haze.y, -hit.z);
  gl_FragColor = vec4(mix(colour, vec3(1.0), pale), min(covered, 1.0));
  vec4 clip = projectionMatrix * vec4(hit, 1.0);
  gl_FragDepth = 0.5 * clip.z / clip.w + 0.5;
}
`;
