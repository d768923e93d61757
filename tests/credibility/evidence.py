"""The words of core/doc/credibility.md and the published figures in it, in their order.

make_page.py fills in the tables.

Published figures keep the name of their source. Where ours differ, the difference is explained, and
nothing is tuned so that it goes away.
"""

OWN_FACE = "synthetic half face"

# Surface-volume coefficients of cadavers (PRS 2019, pubmed 30907804): compartment, the region and
# plane here that come nearest, the published figure.
CADAVER = (
    ("SOOF", "soof", "muscle", 0.94),
    ("superficial lateral forehead", "forehead", "skin", 0.74),
    ("deep lateral forehead", "forehead", "muscle", 0.68),
    ("deep temporal", "temple", "smas", 0.64),
    ("deep medial cheek", "midface", "muscle", 0.29),
)

# Volume that faces of women gained over that injected, fillers of hyaluronic acid (101 women, PRS
# 10/2025).
FILLERS = (
    (
        "mid and lower face",
        ("malar", "nasolabial", "marionette", "chin", "jawline", "masseter"),
        "0.56 to 1.25 at once; about 0.90 after two weeks",
    ),
    ("lips", ("upper_lip", "lower_lip"), "0.56 to 1.25 at once; about 0.70 after two weeks"),
)

ASSUMED = (
    ("stiffness and slack of ligaments", "finite, in the published order", "no absolute figures were found; a plan gives them"),
    ("yield stress of fat", "1 to 20 Pa", "inferred; plans with it are stepped"),
    ("elastic base under the cheek", "1 kPa/mm", "engineering choice; a model gives it"),
    ("attachment around a zone", "by region", "engineering choice; a plan gives it"),
    ("thickness of the SMAS", "1 mm", "no range was found; forecasts vary it"),
    ("density of injected fat", "920 kg/m3", "engineering choice; it acts through gravity alone"),
    ("bounds of the pressure bands above 9 mmHg", "15 and 30 mmHg", "between published capillary pressures"),
    ("retention from patient to patient", "16 % around the published mean", "from study to study; forecasts vary it"),
    ("retention in every zone alike", "one share a patient", "no figures by zone were found"),
    ("reserve of fat to prepare", "10 %", "engineering choice; a report takes another"),
    ("zones misplaced by landmarks", "1.5 mm each way, pressure 2.8 % a mm", "from 90 faces; forecasts vary it"),
)

# Jaw surgery, simulated against scanned soft tissue: the nearest that was published.
OTHERS = (
    ("PINNOCHIO, 40 patients", "86.6 % of points within 2 mm; finite elements 80.9 %"),
    ("PhysSFI-Net, 135 patients", "surface 1.30 +- 0.35 mm"),
    ("mass-tensor model, 100 patients", "mean 0.9 +- 0.3 mm, 90 % within 1.9 mm"),
    ("ProPlan CMF, 10 and 16 patients", "mean 0.72-1.42 mm, 72.5-92.5 % of points under 2 mm"),
    ("SurgiCase, a review", "0.75-0.94 mm, 95 % within 2.47-2.81 mm"),
)

# Figures of a forecast whose intervals were held against cases, and their names in forecasts.json.
INTERVALS = (
    ("largest lift", "largest_lift"),
    ("volume of the skin", "skin_volume"),
    ("pressure", "pressure"),
    ("lift of a vertex", "lift_of_a_vertex"),
)

PARTS = (
    "# Credibility",
    """How far can a figure of Lipofill be trusted, and on what evidence? This page answers by the
    eight categories of evidence that the FDA names in *Assessing the Credibility of Computational
    Modeling and Simulation in Medical Device Submissions* (17 November 2023). Lipofill is a research
    and planning aid, not a medical device; the categories serve as a list that leaves nothing out.""",
    """The page is generated. Its tables come from the [verification suite](verification.md) and from
    `core/doc/credibility.json`, which `deploy/credibility` measures on real runs, and
    `core/doc/forecasts.json`, which `deploy/forecasts` measures; a test compares the page with its
    generator.""",
    """- *Question of interest*: how much fat, where and in which plane, brings the skin of a face
    nearest to a target, and what pressure comes of it?
    - *Context of use*: planning and research. A surgeon decides; the model is one of several things
    to look at.
    - *Risk*: a wrong volume leads to an under- or over-corrected face, a wrong pressure to lost
    grafts. Intervals, bands and remarks are shown beside every figure so that it is not taken for
    more than it is.""",
    "**In one sentence:** the equations are solved correctly, within known errors; that the result is what a face does has "
    "been compared with published figures only, and has not been validated against scans of patients.",
    "## 1. Code verification",
    """Every case has an answer that is known without the solver, and every figure is asserted by a
    test.""",
    "verification_table",
    """A second solver, CalculiX, computes the same tissue under the same pressure:
    {case:coupled-8-calculix}, {case:coupled-10-calculix-neo-hookean}. The settled shape is found in
    two ways: {case:coupled-8-settled-directly}. Equal plans give equal bytes
    whatever the number of workers, and the bytes of the sample plans are pinned.""",
    "## 2. Model calibration",
    """No parameter was fitted to patients of our own. Parameters are published figures with their
    source beside them, or assumed and marked so (category 7). One curve is fitted: the share of fat
    that is left over months is that of the cotton pad arm of one trial (Wu 2018). With another
    share after twelve months the same curve tells the trial's other arm to 0.02 at every time,
    without being fitted to it ([decision 038](decisions/038-retention.md)).""",
    "## 3. Bench tests",
    """No bench of our own. The nearest are cadavers: the surface-volume coefficient is the volume
    that the skin gains over the volume injected (PRS 2019, pubmed 30907804). Here it is the skin's
    gain in {runs} runs on {faces} faces with the preset ELASTOGRAPHY, at rest, in the region and
    plane that come nearest to the compartment. {unsettled}""",
    "cadaver_table",
    "By region and plane, over the same runs:",
    "plane_table",
    """What the differences come from, as far as it is known; nothing was tuned.""",
    """- *The model has little to lose volume to.* Its tissue is nearly incompressible, lies on bone or
    on a stiff base, and fat goes nowhere but into its zone, or through the attachment around it
    where a plan lets it feather out. So nearly all of the volume comes out at the skin. In a cadaver
    filler also spreads along planes beyond the compartment, and displaces what is not skin: the
    mouth, the orbit, the buccal space.
    - *Above 1.* Around a zone the layers are held by an elastic attachment of assumed stiffness, and
    part there a little: that gap lifts the skin and holds no fat. It grows with the pressure, and so
    with the depth of the plane: of 1 mL under the muscle of the forehead the skin gains 1.10 mL, of
    which 0.01 mL is tissue that has dilated and 0.09 mL, by what is left of the balance, that gap. It
    is an error of the model, of up to 20 %.
    - *Deep medial cheek.* The published 0.29 says that most of the volume went elsewhere. The model
    has no space behind the cheek to give way, only an elastic base of assumed stiffness where there
    is no bone; it overstates this compartment most, and is not to be relied upon for deep midface
    volumes.
    - *Compartments are not regions.* A named region is an ellipse placed from landmarks, a
    compartment has septa. The planes are matched by hand.
    - *Dead tissue* has no turgor, and was measured with fillers, not with fat.""",
    "## 4. In vivo",
    """No simulation of fat grafting by this model has been compared with a scan of a patient. It
    would take scans before, at once and at 3, 6 and 12 months with volumes by zone and plane;
    `lipofill evaluate` computes the figures that such a study reports. What can be compared is what
    faces gained from fillers of hyaluronic acid (101 women, PRS 10/2025):""",
    "filler_table",
    """Fillers draw water, and fat does not; the scatter at once is that of swelling and of the
    measurement. The model has neither.""",
    "## 5. Populations",
    """Retention is that of populations: pooled 47 % (27 studies, 1,011 patients), 43 % for acquired
    atrophy, 64 % for mixed indications, 41 and 34 % by preparation. Forecasts show the interval that
    90 of 100 patients lie in, not that of the mean. No published validation of simulated *facial fat
    grafting* against scans was found; that of jaw surgery shows what is reached elsewhere:""",
    "accuracy_table",
    "## 6. Emergent behaviour",
    """What was not put in, and comes out. Fat peels tissue off as lubrication theory has it, with a
    front that moves with a power of time ({case:coupled-7a-round-blister}). A yield stress leaves a
    ridge where it was put ({case:fat-1-arrested-ridge}). How the volume comes out at the skin by
    region and plane, in category 3, follows from tissue, base and bond, and is set nowhere.""",
    "## 7. Plausibility",
    """The laws are those of the field: corotational and neo-Hookean tissue, a film of fat with a
    closed-form flow law, both coupled through the same work ([notation](notation.md) says what is
    neglected). Tissue keeps its volume ({case:coupled-11-tissue-volume}). What is assumed:""",
    "assumed_table",
    """What is not in the model: blood, swelling, scars, ageing, muscles at work, the give of lips and
    orbit, and how grafts die by their depth.""",
    "## 8. Calculation verification and uncertainty",
    """The error of the grid is estimated for every settled result from a second grid half as fine
    (`Summary.discretisation_error`), and was itself held against refined grids:
    {case:coupled-11-discretisation-error}, {case:coupled-12-convergence}. Where the estimate cannot
    be made, the result says why; from 5 % on it is remarked upon.""",
    """What is uncertain of the tissue, the volumes, the place and the retention is carried through
    by ensembles ([decision 037](decisions/037-ensembles.md)). Intervals were held against fresh
    cases: {case:forecast-3-coverage}. Indices were held against closed forms, and against runs:
    {case:forecast-1-ishigami}, {case:forecast-4-sobol}.""",
    """The same at greater length, for a plate with one zone, whose stiffness, thickness and volume are
    uncertain: a forecast of {members} members against {reference_runs} plans of their own, solved
    from rest. Indices of the forecast less those of the runs:""",
    "index_table",
    "The share of cases that lie in the interval of 90 of 100:",
    "interval_table",
    """Both say how well the model knows itself, not how well it knows a face. Landmarks moved by 3 mm change a settled pressure by 8.5 % and the lift by 1 % (90 faces).""",
)
