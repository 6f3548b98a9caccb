//! Receipts for hand-overs in JSON.

use schemars::JsonSchema;
use serde::Serialize;

/// Receipt for a hand-over.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[schemars(rename = "Receipt")]
pub struct ReceiptJson {
    /// Number of the entry of the hand-over.
    pub seq: u64,
    /// Time of the hand-over, RFC 3339 with zone.
    pub time: String,
    /// Sender who handed the mission over.
    pub by: String,
    /// Name of the person or office that took over.
    pub to: String,
    /// Remark; null if there is none.
    pub note: Option<String>,
    /// Code that `hallsweep journal check --receipt` confirms; null if the journal is only in memory.
    pub code: Option<String>,
}

/// Receipts of a mission, the oldest first.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[schemars(rename = "ReceiptList")]
pub struct ReceiptListJson {
    pub mission: u64,
    pub receipts: Vec<ReceiptJson>,
    /// One sentence for each hand-over that cannot be read.
    pub damage: Vec<String>,
    /// Address of the rest of the list; null at the end.
    pub next: Option<String>,
}
