//! modelDescription.xml, from the list of variables.

use std::fmt::Write as _;

use sha2::{Digest, Sha256};

use super::Mode;
use super::variables::{Causality, EXACT_TRACK, Real, TABLE, Variables};

/// Communication step that is proposed, s.
const STEP: f64 = 1e-3;

/// Name and exponents of kg, m, s, rad of every unit.
const UNITS: [(&str, [i32; 4]); 15] = [
    ("m", [0, 1, 0, 0]),
    ("rad", [0, 0, 0, 1]),
    ("s", [0, 0, 1, 0]),
    ("kg", [1, 0, 0, 0]),
    ("kg.m2", [1, 2, 0, 0]),
    ("N", [1, 1, -2, 0]),
    ("N.m", [1, 2, -2, 0]),
    ("N/m", [1, 0, -2, 0]),
    ("N.s/m", [1, 0, -1, 0]),
    ("m/s", [0, 1, -1, 0]),
    ("rad/s", [0, 0, -1, 1]),
    ("rad/m", [0, -1, 0, 1]),
    ("1/m", [0, -1, 0, 0]),
    ("s/m", [0, -1, 1, 0]),
    ("", [0, 0, 0, 0]),
];

/// What the library and a description know each other by: a hash of the mode's variables and the version.
#[must_use]
pub fn guid(mode: Mode) -> String {
    let text = format!("{}\n{}\n{}", env!("CARGO_PKG_VERSION"), mode.identifier(), variables(&Variables::of(mode)));
    let hash = Sha256::digest(text.as_bytes());
    let hex: String = hash.iter().take(16).map(|byte| format!("{byte:02x}")).collect();
    format!("{{{}-{}-{}-{}-{}}}", &hex[..8], &hex[8..12], &hex[12..16], &hex[16..20], &hex[20..])
}

/// modelDescription.xml of a mode.
#[must_use]
pub fn xml(mode: Mode) -> String {
    let list = Variables::of(mode);
    let mut units = String::new();
    for (name, [kg, m, s, rad]) in UNITS.iter().filter(|(name, _)| !name.is_empty()) {
        let _ = writeln!(
            units,
            "    <Unit name=\"{name}\"><BaseUnit kg=\"{kg}\" m=\"{m}\" s=\"{s}\" rad=\"{rad}\"/></Unit>"
        );
    }
    let outputs: String = output_indices(&list).map(|index| format!("      <Unknown index=\"{index}\"/>\n")).collect();
    let variables = variables(&list);
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>
<fmiModelDescription fmiVersion=\"2.0\" modelName=\"{identifier}\" guid=\"{guid}\"
  description=\"{description}\"
  generationTool=\"flangeway {version}\" version=\"{version}\" variableNamingConvention=\"structured\" \
numberOfEventIndicators=\"0\">
  <CoSimulation modelIdentifier=\"{identifier}\" canHandleVariableCommunicationStepSize=\"true\" \
canInterpolateInputs=\"false\" canBeInstantiatedOnlyOncePerProcess=\"false\" canGetAndSetFMUstate=\"true\" \
canSerializeFMUstate=\"false\" providesDirectionalDerivative=\"false\"/>
  <UnitDefinitions>
{units}  </UnitDefinitions>
  <LogCategories>
    <Category name=\"logStatusError\" description=\"Why a call failed\"/>
    <Category name=\"logAll\" description=\"Everything\"/>
  </LogCategories>
  <DefaultExperiment startTime=\"0\" stopTime=\"10\" stepSize=\"{STEP}\"/>
  <ModelVariables>
{variables}  </ModelVariables>
  <ModelStructure>
    <Outputs>
{outputs}    </Outputs>
    <InitialUnknowns>
{outputs}    </InitialUnknowns>
  </ModelStructure>
</fmiModelDescription>
",
        identifier = mode.identifier(),
        guid = guid(mode),
        description = escaped(mode.description()),
        version = env!("CARGO_PKG_VERSION"),
    )
}

/// Positions of the outputs among all variables, counted from 1: reals, integers, then the others.
fn output_indices(list: &Variables) -> impl Iterator<Item = usize> {
    let reals = list.reals.iter().map(|variable| variable.causality);
    let all = reals.chain(list.integers.iter().map(|variable| variable.causality));
    all.enumerate().filter(|(_, causality)| *causality == Causality::Output).map(|(index, _)| index + 1)
}

/// The variables as elements, in the order of their references, reals first.
fn variables(list: &Variables) -> String {
    let mut text = String::new();
    let mut put = |name: &str, reference: usize, causality: Causality, description: &str, value: String| {
        // Integers do not vary continuously.
        let kind = match causality {
            Causality::Parameter => "causality=\"parameter\" variability=\"fixed\" initial=\"exact\"",
            Causality::Input => "causality=\"input\"",
            Causality::Output if value.starts_with("<Integer") => {
                "causality=\"output\" variability=\"discrete\" initial=\"calculated\""
            }
            Causality::Output => "causality=\"output\" initial=\"calculated\"",
        };
        let description = escaped(description);
        let _ = writeln!(
            text,
            "    <ScalarVariable name=\"{name}\" valueReference=\"{reference}\" {kind} \
             description=\"{description}\">{value}</ScalarVariable>"
        );
    };
    for (reference, variable) in list.reals.iter().enumerate() {
        put(&variable.name, reference, variable.causality, &variable.description, real(variable));
    }
    for (reference, variable) in list.integers.iter().enumerate() {
        let [low, high] = variable.range;
        let start = match variable.causality {
            Causality::Output => String::new(),
            _ => format!(" start=\"{}\"", variable.start),
        };
        let value = format!("<Integer min=\"{low}\" max=\"{high}\"{start}/>");
        put(&variable.name, reference, variable.causality, &variable.description, value);
    }
    let [name, description] = TABLE;
    put(name, 0, Causality::Parameter, description, "<String start=\"\"/>".into());
    if list.exact_track {
        let [name, description] = EXACT_TRACK;
        put(name, 0, Causality::Parameter, description, "<Boolean start=\"false\"/>".into());
    }
    text
}

fn real(variable: &Real) -> String {
    let unit = if variable.unit.is_empty() { String::new() } else { format!(" unit=\"{}\"", variable.unit) };
    if variable.causality == Causality::Output {
        return format!("<Real{unit}/>");
    }
    let [low, high] = variable.range;
    format!("<Real{unit} min=\"{low}\" max=\"{high}\" start=\"{}\"/>", variable.start)
}

/// Text as an attribute's value.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_unit_is_defined_and_every_output_listed() {
        for mode in Mode::ALL {
            let list = Variables::of(mode);
            for variable in &list.reals {
                assert!(UNITS.iter().any(|(name, _)| *name == variable.unit), "{} of {}", variable.unit, variable.name);
            }
            let text = xml(mode);
            let outputs = list.reals.len() - list.first_output() + 4;
            assert_eq!(text.matches("causality=\"output\"").count(), outputs);
            assert_eq!(text.matches("<Unknown ").count(), 2 * outputs);
            assert_eq!(text.matches("variability=\"discrete\"").count(), 4);
        }
        assert_ne!(guid(Mode::Wheelset), guid(Mode::Contact));
    }
}
