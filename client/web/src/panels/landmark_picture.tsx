// Where a landmark goes, on a drawn face: the patient's left is on the right of the picture.
const places: Record<string, [number, number]> = {
  nasion: [60, 56],
  pronasale: [60, 84],
  subnasale: [60, 92],
  pogonion: [60, 128],
  menton: [60, 138],
  exocanthion: [85, 58],
  alare: [71, 87],
  cheilion: [76, 106],
  gonion: [96, 112],
  zygion: [103, 70],
  tragion: [109, 66],
};

function placeOf(name: string): [number, number] | undefined {
  const [x, y] = places[name.replace(/_(left|right)$/, "")] ?? [];
  if (x === undefined || y === undefined) return undefined;
  return name.endsWith("_right") ? [120 - x, y] : [x, y];
}

export function LandmarkPicture({ name }: { name: string }) {
  const at = placeOf(name);
  if (at === undefined) return null;
  return (
    <svg
      class="landmark-picture"
      viewBox="0 0 120 150"
      role="img"
      aria-label={`Where ${name.replace(/_/g, " ")} is on a face`}
    >
      <path d="M60 6C32 6 16 30 15 62C15 92 30 124 44 134C50 138 55 139 60 139C65 139 70 138 76 134C90 124 105 92 105 62C104 30 88 6 60 6Z" />
      <path d="M28 58Q37 50 46 58Q37 64 28 58ZM92 58Q83 50 74 58Q83 64 92 58Z" />
      <path d="M57 56Q55 76 49 86Q52 92 60 92Q68 92 71 86Q65 76 63 56M44 106Q52 101 60 104Q68 101 76 106Q68 113 60 113Q52 113 44 106ZM44 106H76M53 126Q60 122 67 126" />
      <path d="M15 60Q8 56 9 66Q11 78 17 80M105 60Q112 56 111 66Q109 78 103 80" />
      <circle cx={at[0]} cy={at[1]} r={4.5} />
    </svg>
  );
}
