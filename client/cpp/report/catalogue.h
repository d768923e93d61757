#pragma once

#include <string_view>

#include "client/cpp/report/language.h"

/// All words of the report, in every language (language.h). Sentences of the daemon, its remarks
/// and sources, stay in English, and are marked as that.
namespace lipofill::client::texts {

// The whole.
inline constexpr Text kTitle = {"Planning report: fat grafting of the face",
                                "Planungsbericht: Fetttransplantation im Gesicht"};
inline constexpr Text kNotice = {"Research and planning aid, not a medical device.",
                                 "Hilfe für Forschung und Planung, kein Medizinprodukt."};
inline constexpr Text kRunningHead = {"Lipofill report, patient $0, $1", "Lipofill-Bericht, Patient $0, $1"};
inline constexpr Text kPageOf = {"page $0 of $1", "Seite $0 von $1"};
inline constexpr Text kNotNamed = {"not named", "nicht benannt"};
inline constexpr Text kTo = {" to ", " bis "};
inline constexpr Text kBelow = {"below $0", "unter: $0"};
inline constexpr Text kNoPlane = {"between walls of its own", "zwischen eigenen Wänden"};
inline constexpr Text kLeftOf = {"$0, left", "$0, links"};
inline constexpr Text kRightOf = {"$0, right", "$0, rechts"};
inline constexpr Text kAtOnce = {"at once", "sofort"};
inline constexpr Text kAfterMonths = {"after $0 months", "nach $0 Monaten"};
inline constexpr Text kAfterOneMonth = {"after 1 month", "nach 1 Monat"};
inline constexpr Text kAll = {"all together", "zusammen"};

// What the report is of.
inline constexpr Text kAbout = {"What this report is of", "Worum es geht"};
inline constexpr Text kFact = {"fact", "Angabe"};
inline constexpr Text kValue = {"value", "Wert"};
inline constexpr Text kPatient = {"patient (pseudonym)", "Patient (Pseudonym)"};
inline constexpr Text kDate = {"date", "Datum"};
inline constexpr Text kScan = {"scan", "Scan"};
inline constexpr Text kScanIs = {"$0 vertices, $1 triangles; SHA-256 $2", "$0 Punkte, $1 Dreiecke; SHA-256 $2"};
inline constexpr Text kNoScan = {"none: a flat square", "keiner: ein flaches Quadrat"};
inline constexpr Text kPlan = {"plan", "Plan"};
inline constexpr Text kFat = {"fat", "Fett"};
inline constexpr Text kState = {"simulation", "Simulation"};
inline constexpr Text kSettled = {"at rest: the settled shape, found $0",
                                  "in Ruhe: die Form, in der alles ruht, gefunden $0"};
inline constexpr Text kDirectly = {"directly", "direkt"};
inline constexpr Text kNotSettled = {"NOT at rest when the time of the plan ended: figures are of that moment",
                                     "NICHT in Ruhe, als die Zeit des Plans endete: Zahlen gelten für diesen Moment"};

// At a glance.
inline constexpr Text kGlance = {"At a glance", "Auf einen Blick"};
inline constexpr Text kGlanceCaption = {"The plan as it is", "Der Plan, wie er ist"};
inline constexpr Text kToPrepare = {"to prepare [mL]", "vorzubereiten [mL]"};
inline constexpr Text kToInject = {"to inject [mL]", "zu injizieren [mL]"};
inline constexpr Text kRemains = {"left $0 [mL]", "übrig $0 [mL]"};
inline constexpr Text kShareLeft = {"share of the fat that is left $0 (90 of 100 patients)",
                                    "Anteil des Fetts, der $0 übrig ist (90 von 100 Patienten)"};
inline constexpr Text kLift = {"largest movement of the skin", "größte Bewegung der Haut"};
inline constexpr Text kHighestPressure = {"highest mean pressure of a zone, settled",
                                          "höchster mittlerer Druck einer Zone, in Ruhe"};
inline constexpr Text kGridError = {"error of the grid (estimated from a second one, half as fine)",
                                    "Fehler des Gitters (geschätzt aus einem zweiten, halb so feinen)"};
inline constexpr Text kGridLift = {"movement ", "Bewegung "};
inline constexpr Text kGridPressure = {", pressure ", ", Druck "};
inline constexpr Text kGridSkin = {", skin ", ", Haut "};
inline constexpr Text kGridPlaces = {" at 95 of 100 places", " an 95 von 100 Stellen"};
inline constexpr Text kNoGridError = {"not known: $0", "nicht bekannt: $0"};
inline constexpr Text kGridLarge = {" \u26a0 coarse: 5 % or more", " \u26a0 grob: 5 % oder mehr"};
inline constexpr Text kGridNoOrder = {
    " \u26a0 a plain difference of two grids: over three the error does not fall with "
    "its order",
    " \u26a0 einfache Differenz zweier Gitter: Über drei fällt der Fehler nicht mit "
    "seiner Ordnung"};
inline constexpr Text kMissing = {"missing to the target [mL]", "fehlt zum Ziel [mL]"};
inline constexpr Text kBeforeThen = {"before", "vorher"};

// Views.
inline constexpr Text kViews = {"Standard views", "Standardansichten"};
inline constexpr Text kView = {"view", "Ansicht"};
inline constexpr Text kViewsCaption = {"The face from five sides; left and right are the patient's own",
                                       "Das Gesicht von fünf Seiten; links und rechts sind die des Patienten"};
inline constexpr Text kFront = {"front", "vorn"};
inline constexpr Text kRightOblique = {"right oblique", "rechts schräg"};
inline constexpr Text kLeftOblique = {"left oblique", "links schräg"};
inline constexpr Text kRightProfile = {"right profile", "rechtes Profil"};
inline constexpr Text kLeftProfile = {"left profile", "linkes Profil"};
inline constexpr Text kBefore = {"before", "vorher"};
inline constexpr Text kPlanned = {"planned, at once", "geplant, sofort"};
inline constexpr Text kRemaining = {"planned, $0", "geplant, $0"};
inline constexpr Text kTargetColumn = {"target", "Ziel"};
inline constexpr Text kViewAlternative = {"The skin $0, view: $1", "Die Haut $0, Ansicht: $1"};
inline constexpr Text kRemainingShape = {
    "The shape $0 is that of the plan with $1 of its fat, what is left in the median. Swelling, scars and bruises are "
    "not in the pictures.",
    "Die Form $0 ist die des Plans mit $1 seines Fetts, dem Median dessen, was übrig ist. Schwellung, Narben und "
    "Blutergüsse sind nicht in den Bildern."};
inline constexpr Text kNoPictures = {"The pictures could not be drawn: $0",
                                     "Die Bilder konnten nicht gezeichnet werden: $0"};

// Maps.
inline constexpr Text kMaps = {"Maps", "Karten"};
inline constexpr Text kDisplacementMap = {"Movement of the skin, planned, at once",
                                          "Bewegung der Haut, geplant, sofort"};
inline constexpr Text kPressureMap = {"Pressure of the fat below, settled", "Druck des Fetts darunter, in Ruhe"};
inline constexpr Text kDeficitMap = {"Distance from the target before", "Abstand vom Ziel vorher"};
inline constexpr Text kPlannedDistanceMap = {"Distance from the target, planned, at once",
                                             "Abstand vom Ziel, geplant, sofort"};
inline constexpr Text kRemainingDistanceMap = {"Distance from the target, planned, $0",
                                               "Abstand vom Ziel, geplant, $0"};
inline constexpr Text kDisplacementScale = {"movement", "Bewegung"};
inline constexpr Text kDistanceScale = {"negative: missing; positive: too much", "negativ: fehlt; positiv: zu viel"};
inline constexpr Text kLinesOfDistance = {
    "Lines on the maps of distance run every $0 mm: dark where skin is missing, white where it is too much. On skin "
    "without a colour nothing is compared.",
    "Linien in den Abstandskarten liegen $0 mm auseinander: dunkel, wo Haut fehlt, weiß, wo sie zu viel ist. Auf Haut "
    "ohne Farbe wird nichts verglichen."};
inline constexpr Text kMapAlternative = {"$0, on the skin seen from where it moves most",
                                         "$0, auf der Haut, gesehen von dort, wo sie sich am meisten bewegt"};

// Volumes.
inline constexpr Text kVolumes = {"Volumes", "Volumen"};
inline constexpr Text kVolumesOfPlan = {"The plan as it is, by zone and plane",
                                        "Der Plan, wie er ist, nach Zone und Schicht"};
inline constexpr Text kZone = {"zone", "Zone"};
inline constexpr Text kPlane = {"plane", "Schicht"};
inline constexpr Text kReserve = {
    "To prepare is what is injected and a reserve of $0 for what stays in syringes and cannulas (assumed). Zones "
    "lose fat alike; intervals in brackets hold 90 of 100 patients.",
    "Vorzubereiten ist, was injiziert wird, und eine Reserve von $0 für das, was in Spritzen und Kanülen bleibt "
    "(angenommen). Alle Zonen verlieren gleich viel Fett; Intervalle in Klammern enthalten 90 von 100 Patienten."};
inline constexpr Text kOverCorrection = {"So that the wanted volume is left $0",
                                         "Damit das gewünschte Volumen $0 übrig ist"};
inline constexpr Text kWanted = {"wanted [mL]", "gewünscht [mL]"};
inline constexpr Text kInjectFor = {"to inject in all [mL]", "insgesamt zu injizieren [mL]"};
inline constexpr Text kMostAtOnce = {"most at once [mL]", "höchstens auf einmal [mL]"};
inline constexpr Text kSessions = {"Sessions that lead there", "Sitzungen, die dorthin führen"};
inline constexpr Text kSession = {"session $0, month $1", "Sitzung $0, Monat $1"};
inline constexpr Text kSessionColumn = {"session", "Sitzung"};
inline constexpr Text kPresent = {"still there before [mL]", "vorher noch da [mL]"};
inline constexpr Text kNoSessions = {
    "The wanted volumes cannot be reached below the pressure band: no sessions are given.",
    "Die gewünschten Volumen sind unter dem Druckband nicht zu erreichen: Sitzungen "
    "werden nicht angegeben."};
inline constexpr Text kNoSessionsAsked = {
    "No forecast was asked for: the plan is one session, and how much to inject so that a volume is left is not told.",
    "Es wurde keine Vorhersage verlangt: Der Plan ist eine Sitzung, und wie viel zu injizieren ist, damit ein Volumen "
    "übrig bleibt, wird nicht gesagt."};

// Pressure.
inline constexpr Text kPressure = {"Pressure", "Druck"};
inline constexpr Text kPressureCaption = {"Mean settled pressure by zone, and how likely each band is",
                                          "Mittlerer Druck in Ruhe nach Zone, und wie wahrscheinlich jedes Band ist"};
inline constexpr Text kMeanPressure = {"mean [mmHg]", "Mittel [mmHg]"};
inline constexpr Text kMeanKilopascals = {"mean [kPa]", "Mittel [kPa]"};
inline constexpr Text kBand = {"band", "Band"};
inline constexpr Text kBand9 = {"below 9 mmHg", "unter 9 mmHg"};
inline constexpr Text kBand15 = {"9 to 15 mmHg", "9 bis 15 mmHg"};
inline constexpr Text kBand30 = {"15 to 30 mmHg", "15 bis 30 mmHg"};
inline constexpr Text kBandAbove = {"above 30 mmHg", "über 30 mmHg"};
inline constexpr Text kProbability = {"$0 [%]", "$0 [%]"};
inline constexpr Text kWhen = {"when", "wann"};
inline constexpr Text kBandsAssumed = {
    "9 mmHg is the critical interstitial pressure (Khouri 2014); the other bounds are assumed. The pressure while "
    "injecting is higher.",
    "9 mmHg ist der kritische interstitielle Druck (Khouri 2014); die anderen Grenzen sind angenommen. Während der "
    "Injektion ist der Druck höher."};
inline constexpr Text kNoBands = {"Probabilities need a forecast, which was not asked for.",
                                  "Wahrscheinlichkeiten brauchen eine Vorhersage, die nicht verlangt wurde."};

// Target.
inline constexpr Text kTarget = {"Target", "Ziel"};
inline constexpr Text kNoTarget = {"No target was asked for: what is missing on this face was not measured.",
                                   "Es wurde kein Ziel verlangt: Was an diesem Gesicht fehlt, wurde nicht gemessen."};
inline constexpr Text kMirroredTarget = {"The target is the other side, mirrored from: $0.",
                                         "Das Ziel ist die andere Seite, gespiegelt von: $0."};
inline constexpr Text kLeftSide = {"left", "links"};
inline constexpr Text kRightSide = {"right", "rechts"};
inline constexpr Text kSurfaceTarget = {"The target is a surface of the same face, SHA-256 $0.",
                                        "Das Ziel ist eine Fläche desselben Gesichts, SHA-256 $0."};
inline constexpr Text kDistances = {"The skin of the model and its target, rim left out",
                                    "Die Haut des Modells und ihr Ziel, ohne Rand"};
inline constexpr Text kFigure = {"figure", "Größe"};
inline constexpr Text kTooMuch = {"too much [mL]", "zu viel [mL]"};
inline constexpr Text kRms = {"root of the mean square distance [mm]", "Wurzel des mittleren Abstandsquadrats [mm]"};
inline constexpr Text kP95 = {"95 of 100 places are nearer than [mm]", "95 von 100 Stellen sind näher als [mm]"};
inline constexpr Text kHausdorff = {"largest distance [mm]", "größter Abstand [mm]"};
inline constexpr Text kUnder2 = {"places nearer than 2 mm [%]", "Stellen näher als 2 mm [%]"};
inline constexpr Text kSymmetry = {"symmetry index [mm]", "Symmetrieindex [mm]"};
inline constexpr Text kRegions = {"What the face lacks before, by region", "Was dem Gesicht vorher fehlt, nach Region"};
inline constexpr Text kRegion = {"region", "Region"};
inline constexpr Text kDeepest = {"deepest [mm]", "am tiefsten [mm]"};
inline constexpr Text kRegionsOverlap = {
    "Regions overlap: their volumes do not add up. Those that lack most come first.",
    "Regionen überlappen sich: Ihre Volumen addieren sich nicht. Zuerst kommen die, "
    "denen am meisten fehlt."};

// Delivery.
inline constexpr Text kDelivery = {"Delivery list", "Injektionsliste"};
inline constexpr Text kNoDelivery = {"There is no delivery list: $0", "Es gibt keine Injektionsliste: $0"};
inline constexpr Text kEntries = {"Entries of the cannula", "Einstiche der Kanüle"};
inline constexpr Text kEntry = {"entry", "Einstich"};
inline constexpr Text kPlace = {"place x, y, z [mm]", "Ort x, y, z [mm]"};
inline constexpr Text kVolume = {"volume [mL]", "Volumen [mL]"};
inline constexpr Text kPasses = {"passes", "Züge"};
inline constexpr Text kTunnels = {"Tunnels, in the order in which they are made",
                                  "Tunnel, in der Reihenfolge ihrer Anlage"};
inline constexpr Text kTunnel = {"tunnel", "Tunnel"};
inline constexpr Text kEntryTunnel = {"entry $0, tunnel $1", "Einstich $0, Tunnel $1"};
inline constexpr Text kPassMost = {"most in a pass [mL]", "höchstens je Zug [mL]"};

// Forecast.
inline constexpr Text kForecast = {"Forecast", "Vorhersage"};
inline constexpr Text kNoForecast = {
    "No forecast was asked for: the figures of this report are those of the plan with the "
    "tissue as the model has it, and have no interval.",
    "Es wurde keine Vorhersage verlangt: Die Zahlen dieses Berichts gelten für den Plan "
    "mit dem Gewebe, wie das Modell es hat, und haben kein Intervall."};
inline constexpr Text kForecastRefused = {"There is no forecast: $0", "Es gibt keine Vorhersage: $0"};
inline constexpr Text kForecastOf = {"$0 of $1 cases of tissue, volume, place and retention came to rest.",
                                     "$0 von $1 Fällen von Gewebe, Volumen, Ort und Erhalt kamen zur Ruhe."};
inline constexpr Text kIntervals = {"In the median, and in brackets the interval that holds 90 of 100 cases",
                                    "Im Median, und in Klammern das Intervall, das 90 von 100 Fällen enthält"};
inline constexpr Text kMaxLift = {"largest movement of the skin [mm]", "größte Bewegung der Haut [mm]"};
inline constexpr Text kSkinVolume = {"volume under the skin [mL]", "Volumen unter der Haut [mL]"};
inline constexpr Text kZonePressure = {"mean pressure, $0 [mmHg]", "mittlerer Druck, $0 [mmHg]"};
inline constexpr Text kZoneVolume = {"fat, $0 [mL]", "Fett, $0 [mL]"};
inline constexpr Text kCauses = {"What the spread comes from", "Woher die Streuung kommt"};
inline constexpr Text kCause = {"causes, with their share of the variance",
                                "Ursachen, mit ihrem Anteil an der Varianz"};
inline constexpr Text kUnexplained = {"not told: $0 of the variance is unexplained",
                                      "nicht gesagt: $0 der Varianz ist unerklärt"};
inline constexpr Text kNoSpread = {"it does not vary", "sie streut nicht"};
inline constexpr Text kRetention = {"How much of the fat is left", "Wie viel vom Fett übrig ist"};
inline constexpr Text kShare = {"share that is left [%]", "Anteil, der übrig ist [%]"};
inline constexpr Text kRetentionUpdated = {"A follow-up sharpened these figures.",
                                           "Eine Nachuntersuchung hat diese Zahlen geschärft."};

// Tissue.
inline constexpr Text kTissue = {"Tissue", "Gewebe"};
inline constexpr Text kLayers = {"Layers of the model, from the skin inwards",
                                 "Schichten des Modells, von der Haut nach innen"};
inline constexpr Text kLayer = {"layer", "Schicht"};
inline constexpr Text kThickness = {"thickness [mm]", "Dicke [mm]"};
inline constexpr Text kModulus = {"Young's modulus [kPa]", "E-Modul [kPa]"};
inline constexpr Text kPoisson = {"Poisson's ratio", "Querdehnzahl"};
inline constexpr Text kDensity = {"density [kg/m\u00b3]", "Dichte [kg/m\u00b3]"};
inline constexpr Text kLaw = {"law", "Gesetz"};
inline constexpr Text kInputs = {"How well it is known, and where that comes from", "Wie gut man es kennt, und woher"};
inline constexpr Text kInput = {"quantity", "Größe"};
inline constexpr Text kDistribution = {"distribution", "Verteilung"};
inline constexpr Text kSource = {"source", "Quelle"};
inline constexpr Text kBasis = {"basis", "Grundlage"};
inline constexpr Text kPublished = {"published or given", "veröffentlicht oder angegeben"};
inline constexpr Text kAssumed = {"assumed", "angenommen"};
inline constexpr Text kLayerModulus = {"stiffness of $0, times the model's", "Steifigkeit von $0, mal die des Modells"};
inline constexpr Text kLayerThickness = {"thickness of $0, times the model's", "Dicke von $0, mal die des Modells"};
inline constexpr Text kDeliveredVolume = {"volume delivered into $0, times the plan's",
                                          "in $0 gebrachtes Volumen, mal das des Plans"};
inline constexpr Text kPlaceXi = {"place of the zones along xi [mm]", "Ort der Zonen längs xi [mm]"};
inline constexpr Text kPlaceEta = {"place of the zones along eta [mm]", "Ort der Zonen längs eta [mm]"};
inline constexpr Text kRetentionInput = {"share of the fat that is left after 12 months",
                                         "Anteil des Fetts, der nach 12 Monaten übrig ist"};
inline constexpr Text kNormal = {"normal", "normal"};
inline constexpr Text kLogNormal = {"log-normal", "lognormal"};
inline constexpr Text kUniform = {"uniform", "gleichverteilt"};
inline constexpr Text kTriangular = {"triangular", "dreieckig"};
inline constexpr Text kAround = {" around ", " um "};
inline constexpr Text kSpread = {", spread ", ", Streuung "};
inline constexpr Text kWithin = {", within ", ", zwischen "};
inline constexpr Text kNoInputs = {"What is uncertain of this plan is not known: it has to be stepped.",
                                   "Was an diesem Plan ungewiss ist, ist nicht bekannt: Er muss in Schritten gehen."};

// Remarks and origin.
inline constexpr Text kRemarks = {"Before relying on it", "Bevor man sich darauf verlässt"};
inline constexpr Text kNoRemarks = {"There is nothing unusual to remark on.",
                                    "Es gibt nichts Ungewöhnliches zu bemerken."};
inline constexpr Text kNotValidated = {
    "No simulation of fat grafting in the face has been validated against scans after operations. Credibility: "
    "core/doc/credibility.md.",
    "Keine Simulation der Fetttransplantation im Gesicht ist an Scans nach Operationen validiert. Glaubwürdigkeit: "
    "core/doc/credibility.md."};
inline constexpr Text kOrigin = {"Where it comes from", "Woher es kommt"};
inline constexpr Text kHashes = {"Equal inputs have equal hashes", "Gleiche Eingaben haben gleiche Hashwerte"};
inline constexpr Text kPlanHash = {"file of the plan, SHA-256", "Datei des Plans, SHA-256"};
inline constexpr Text kScanHash = {"file of the scan, SHA-256", "Datei des Scans, SHA-256"};
inline constexpr Text kTargetHash = {"target, SHA-256", "Ziel, SHA-256"};
inline constexpr Text kModelHash = {"model, content hash", "Modell, Hashwert des Inhalts"};
inline constexpr Text kShapeHash = {"planned shape, state hash", "geplante Form, Hashwert des Zustands"};
inline constexpr Text kForecastHash = {"forecast, content hash", "Vorhersage, Hashwert des Inhalts"};
inline constexpr Text kVersion = {"Lipofill version", "Version von Lipofill"};
inline constexpr Text kRerun = {"This line makes the report again:", "Diese Zeile macht den Bericht noch einmal:"};

/// Names that plans and models have, as people call them. What is not here is shown as it is.
struct Name {
  std::string_view id;
  Text text;
};
inline constexpr Name kNames[] = {
    {"skin", {"skin", "Haut"}},
    {"subcutaneous", {"subcutaneous fat", "Unterhautfett"}},
    {"subcutaneous_fat", {"subcutaneous fat", "Unterhautfett"}},
    {"smas", {"SMAS", "SMAS"}},
    {"muscle", {"muscle", "Muskel"}},
    {"masseter", {"masseter", "Masseter"}},
    {"mandibular_angle", {"mandibular angle", "Kieferwinkel"}},
    {"buccal", {"buccal region", "Wange"}},
    {"malar", {"malar region", "Jochbeingegend"}},
    {"zygomatic", {"zygomatic arch", "Jochbogen"}},
    {"soof", {"SOOF", "SOOF"}},
    {"tear_trough", {"tear trough", "Tränenrinne"}},
    {"midface", {"midface", "Mittelgesicht"}},
    {"nasolabial", {"nasolabial fold", "Nasolabialfalte"}},
    {"upper_lip", {"upper lip", "Oberlippe"}},
    {"lower_lip", {"lower lip", "Unterlippe"}},
    {"marionette", {"marionette line", "Marionettenfalte"}},
    {"chin", {"chin", "Kinn"}},
    {"jawline", {"jawline", "Kieferlinie"}},
    {"submaxillary", {"submaxillary region", "Unterkiefergegend"}},
    {"temple", {"temple", "Schläfe"}},
    {"forehead", {"forehead", "Stirn"}},
    {"COROTATIONAL", {"corotational", "korotational"}},
    {"NEO_HOOKEAN", {"neo-Hookean", "neo-Hooke"}},
    {"LAW_UNSPECIFIED", {"corotational", "korotational"}},
    {"NEWTONIAN", {"Newtonian", "newtonsch"}},
    {"FAT_PRESET_UNSPECIFIED", {"Newtonian", "newtonsch"}},
    {"COLEMAN", {"Coleman", "Coleman"}},
    {"NANOFAT", {"nanofat", "Nanofett"}},
    {"SVF_GEL", {"SVF gel", "SVF-Gel"}},
};

}  // namespace lipofill::client::texts
