import { Color, MeshDepthMaterial, MeshLambertMaterial, Vector2 } from 'three';

/** Parts in a row of their texture, and texels of a part: three rows of its matrix and its colour. */
export const PARTS_PER_ROW = 64;
export const TEXELS = 4;

/** Shared by all materials: where the grid lies under the scene's origin, m, and its colour. */
export const gridUniforms = { gridOffset: { value: new Vector2() }, gridColor: { value: new Color(0x5c625f) } };

const FETCH_PART = `
attribute float part;
uniform highp sampler2D parts;
vec4 partRow[3];
vec3 partColor;
void fetchPart() {
  int index = int(part);
  ivec2 at = ivec2(${TEXELS} * (index % ${PARTS_PER_ROW}), index / ${PARTS_PER_ROW});
  partRow[0] = texelFetch(parts, at, 0);
  partRow[1] = texelFetch(parts, at + ivec2(1, 0), 0);
  partRow[2] = texelFetch(parts, at + ivec2(2, 0), 0);
  partColor = texelFetch(parts, at + ivec2(3, 0), 0).rgb;
}
vec3 partPoint(vec3 p) {
  vec4 q = vec4(p, 1.0);
  return vec3(dot(partRow[0], q), dot(partRow[1], q), dot(partRow[2], q));
}
// Squares of the sizes along the axes.
vec3 partScale() {
  return partRow[0].xyz * partRow[0].xyz + partRow[1].xyz * partRow[1].xyz + partRow[2].xyz * partRow[2].xyz;
}
vec3 partNormal(vec3 n) {
  vec3 q = n / partScale();
  return vec3(dot(partRow[0].xyz, q), dot(partRow[1].xyz, q), dot(partRow[2].xyz, q));
}
`;

const VARYINGS = `
varying vec3 vPartColor;
#ifdef BOX_EDGES
varying vec3 vHalf;
varying vec3 vOnBox;
#endif
#ifdef GROUND_GRID
varying vec3 vOnGround;
#endif
`;

const VERTEX = `
vec3 transformed = partPoint(position);
vPartColor = partColor;
#ifdef BOX_EDGES
  vHalf = sqrt(partScale());
  vOnBox = position * vHalf;
#endif
#ifdef GROUND_GRID
  // z: how far up the surface faces; there is no other use for the height.
  vOnGround = vec3(transformed.xz, normalize(objectNormal).y);
#endif
`;

const FRAGMENT_FUNCTIONS = `
uniform vec2 gridOffset;
uniform vec3 gridColor;
// Share of the pixel that lies on a line of the grid; lines closer than a few pixels fade out.
float gridLines(vec2 at, float spacing, float pixels) {
  vec2 q = at / spacing;
  vec2 w = max(fwidth(q), vec2(1e-6));
  vec2 lines = clamp(pixels * 0.5 + 0.5 - abs(fract(q - 0.5) - 0.5) / w, 0.0, 1.0);
  vec2 seen = 1.0 - smoothstep(0.06, 0.3, w);
  return max(lines.x * seen.x, lines.y * seen.y);
}
`;

const FRAGMENT = `
diffuseColor.rgb *= vPartColor;
#ifdef BOX_EDGES
{
  vec3 inside = vHalf - abs(vOnBox);
  // On a face one of the three is zero; the next one is the way to the nearest edge.
  float d = max(min(inside.x, inside.y), min(max(inside.x, inside.y), inside.z));
  float width = min(0.006, 0.08 * min(vHalf.x, min(vHalf.y, vHalf.z)));
  float pixel = max(fwidth(d), 1e-6);
  float line = clamp((width - d) / pixel + 0.5, 0.0, 1.0) * clamp(4.0 * width / pixel, 0.0, 1.0);
  diffuseColor.rgb *= 1.0 - 0.45 * line;
}
#endif
#ifdef GROUND_GRID
{
  vec2 at = vOnGround.xy + gridOffset;
  float lines = max(0.25 * gridLines(at, 1.0, 1.0), 0.5 * gridLines(at, 10.0, 1.5));
  diffuseColor.rgb = mix(diffuseColor.rgb, gridColor, smoothstep(0.6, 0.8, vOnGround.z) * lines);
}
#endif
`;

/** Replaces each of the `#include <name>` of a shader of three.js. */
function rewrite(source, replacements) {
  return Object.entries(replacements).reduce(
    (text, [name, code]) => text.replace(`#include <${name}>`, () => code),
    source,
  );
}

/**
 * The matte material of bodies, and the one that their shadows are drawn with. Both take place and colour of each part
 * from the texture. Boxes may have dark edges a few millimetres wide, so that bricks of one colour are told apart; what
 * faces up may have a grid of 1 m and 10 m.
 * @param {{value: DataTexture}} parts  @param {{edges?: boolean, grid?: boolean}} look
 */
export function partMaterials(parts, { edges = false, grid = false } = {}) {
  const surface = new MeshLambertMaterial();
  surface.defines = { ...(edges && { BOX_EDGES: '' }), ...(grid && { GROUND_GRID: '' }) };
  surface.onBeforeCompile = (shader) => {
    Object.assign(shader.uniforms, gridUniforms, { parts });
    shader.vertexShader = rewrite(shader.vertexShader, {
      common: `#include <common>\n${FETCH_PART}\n${VARYINGS}`,
      beginnormal_vertex: 'fetchPart();\nvec3 objectNormal = partNormal(normal);',
      begin_vertex: VERTEX,
    });
    shader.fragmentShader = rewrite(shader.fragmentShader, {
      common: `#include <common>\n${VARYINGS}\n${FRAGMENT_FUNCTIONS}`,
      color_fragment: FRAGMENT,
    });
  };
  const depth = new MeshDepthMaterial();
  depth.onBeforeCompile = (shader) => {
    shader.uniforms.parts = parts;
    shader.vertexShader = rewrite(shader.vertexShader, {
      common: `#include <common>\n${FETCH_PART}`,
      begin_vertex: 'fetchPart();\nvec3 transformed = partPoint(position);',
    });
  };
  return { surface, depth };
}
