// Names of landmarks in common schemes, as client/cpp/landmark_names.cc understands them.

interface Known {
  name: string;
  isPaired: boolean;
  aliases: string[];
}

const known: Known[] = [
  { name: "nasion", isPaired: false, aliases: ["nasion", "n", "na"] },
  { name: "pronasale", isPaired: false, aliases: ["pronasale", "prn", "pn", "nosetip"] },
  { name: "subnasale", isPaired: false, aliases: ["subnasale", "sn"] },
  { name: "pogonion", isPaired: false, aliases: ["pogonion", "pg", "pog"] },
  { name: "menton", isPaired: false, aliases: ["menton", "me"] },
  { name: "exocanthion", isPaired: true, aliases: ["exocanthion", "ex", "exo", "exc", "exocanthus"] },
  { name: "cheilion", isPaired: true, aliases: ["cheilion", "ch", "chelion"] },
  { name: "gonion", isPaired: true, aliases: ["gonion", "go"] },
  { name: "zygion", isPaired: true, aliases: ["zygion", "zy", "zyg"] },
  { name: "tragion", isPaired: true, aliases: ["tragion", "t", "tr", "tra", "tragus"] },
  { name: "alare", isPaired: true, aliases: ["alare", "al"] },
];
const fillers = ["soft", "tissue", "landmark", "lm"];
const sides: [string, string[]][] = [
  ["left", ["left", "l", "lt"]],
  ["right", ["right", "r", "rt"]],
];

const find = (word: string): Known | undefined => known.find(({ aliases }) => aliases.includes(word));
const sideOf = (word: string): string | undefined => sides.find(([, words]) => words.includes(word))?.[0];

/** A side at the front or the back of one word: "gor", "lgo", "gonionleft". */
function gluedSide(word: string): [string, string] | undefined {
  for (const [side, words] of sides) {
    for (const text of words) {
      if (word.endsWith(text) && find(word.slice(0, -text.length))) return [side, word.slice(0, -text.length)];
      if (word.startsWith(text) && find(word.slice(text.length))) return [side, word.slice(text.length)];
    }
  }
  return undefined;
}

/** The name the daemon has for a landmark, undefined for one that is not known. */
export function understandName(name: string): string | undefined {
  const words = name
    .replaceAll("'", "")
    .replace(/([a-z])([A-Z])/g, "$1 $2")
    .toLowerCase()
    .split(/[^a-z0-9]+/)
    .filter((word) => word !== "" && !fillers.includes(word));
  const at = words.length > 1 ? words.findIndex((word) => sideOf(word) !== undefined) : -1;
  let side = at < 0 ? undefined : sideOf(words.splice(at, 1)[0]);
  let rest = words.join("");
  if (side === undefined && find(rest) === undefined) [side, rest] = gluedSide(rest) ?? [undefined, rest];
  const found = find(rest);
  if (found?.isPaired !== (side !== undefined)) return undefined;
  return side === undefined ? found.name : `${found.name}_${side}`;
}
