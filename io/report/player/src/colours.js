// Colours that also those tell apart who do not see all of them.

/** Of kinds (Okabe & Ito). */
const KINDS = ["#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00", "#f0e442", "#555555"];
/** From small to large, evenly bright (stops of viridis). */
const SCALE = ["#440154", "#482878", "#3e4a89", "#31688e", "#26828e", "#1f9e89", "#35b779", "#6ece58", "#b5de2b", "#fde725"];

export const kindColour = (kind) => KINDS[kind % KINDS.length];

export const scaleGradient = () => `linear-gradient(to right, ${SCALE.join(",")})`;

const rgb = (colour) => [1, 3, 5].map((place) => parseInt(colour.slice(place, place + 2), 16));

/** Red, green and blue of a place between 0 and 1 on the scale. */
function onScale(place) {
  const stop = place * (SCALE.length - 1);
  const below = Math.min(Math.floor(stop), SCALE.length - 2);
  const [from, to] = [rgb(SCALE[below]), rgb(SCALE[below + 1])];
  return from.map((value, channel) => value + (stop - below) * (to[channel] - value));
}

/** Bytes of a texture of 256 colours: of kinds, or of a scale. */
export function palette(isOfKinds) {
  const colour = (value) => (isOfKinds ? rgb(kindColour(value)) : onScale(value / 255));
  return Uint8Array.from(Array.from({ length: 256 }, (_, value) => [...colour(value), 255]).flat());
}
