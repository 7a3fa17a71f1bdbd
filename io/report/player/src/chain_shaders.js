// A line is a band that faces the eye, shaded like a cylinder.

/** Places the corners of the band. */
export const vertex = `
uniform mat3 edges;
uniform highp usampler2D starts;
uniform highp isampler2D steps;
uniform float thickest;
varying float across;

const vec2 corners[6] = vec2[6](
  vec2(0, -1), vec2(1, -1), vec2(1, 1), vec2(0, -1), vec2(1, 1), vec2(0, 1)
);

void main() {
  int line = gl_VertexID / 6;
  ivec2 listed = ivec2(line % 1024, line / 1024);
  vec4 start = vec4(texelFetch(starts, listed, 0));
  vec3 from = edges * ((start.xyz + 0.5) / 65536.0);
  vec3 along = edges * (vec3(texelFetch(steps, listed, 0).xyz) / 32768.0);
  vec2 corner = corners[gl_VertexID % 6];
  vec3 place = (modelViewMatrix * vec4(from + corner.x * along, 1.0)).xyz;
  vec3 axis = (modelViewMatrix * vec4(along, 0.0)).xyz;
  vec3 away = isOrthographic ? vec3(0.0, 0.0, -1.0) : normalize(place);
  vec3 side = cross(axis, away);
  float seen = length(side);
  across = corner.y;
  place += (seen > 0.0 ? side / seen : vec3(0.0)) * across * thickest * start.w / 255.0;
  gl_Position = projectionMatrix * vec4(place, 1.0);
}
`;

export const fragment = `
varying float across;

void main() {
  float facing = sqrt(max(1.0 - across * across, 0.0));
  gl_FragColor = vec4(vec3(0.75, 0.12, 0.05) * (0.45 + 0.55 * facing), 1.0);
}
`;
