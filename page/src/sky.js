import { BackSide, BufferAttribute, Color, Mesh, MeshBasicMaterial, SphereGeometry } from 'three';

/** Colours of a clear late morning. */
export const SKY = { zenith: 0x6f9bc4, horizon: 0xdbe4ea, sun: 0xfff0d8, fill: 0xcfe0f2, bounce: 0xa79d8e };

/** A dome around the camera, from the horizon's colour to the zenith's. */
export function makeSky() {
  const geometry = new SphereGeometry(1, 24, 32);
  const { position } = geometry.attributes;
  const colors = new Float32Array(position.count * 3);
  const horizon = new Color(SKY.horizon);
  const zenith = new Color(SKY.zenith);
  for (let i = 0; i < position.count; ++i) {
    const height = Math.max(position.getY(i), 0);
    horizon
      .clone()
      .lerp(zenith, Math.min(1.15 * height ** 0.75, 1))
      .toArray(colors, i * 3);
  }
  geometry.setAttribute('color', new BufferAttribute(colors, 3));
  const material = new MeshBasicMaterial({
    vertexColors: true,
    side: BackSide,
    fog: false,
    depthWrite: false,
    toneMapped: false,
  });
  const sky = new Mesh(geometry, material);
  sky.renderOrder = -1;
  sky.frustumCulled = false;
  sky.scale.setScalar(500);
  return sky;
}
