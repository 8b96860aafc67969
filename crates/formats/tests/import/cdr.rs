//! Writer of CDR for tests: values one after the other, aligned to their size.

/// Value of a message.
#[derive(Debug, Clone)]
pub enum Value {
    Byte(u8),
    I32(i32),
    U32(u32),
    F64(f64),
    Text(String),
    Bytes(Vec<u8>),
    /// Number of values, then these.
    Sequence(Vec<Value>),
    /// Values alone: structures and arrays.
    All(Vec<Value>),
}

pub fn text(text: &str) -> Value {
    Value::Text(text.to_owned())
}

pub fn numbers(numbers: &[f64]) -> Value {
    Value::All(numbers.iter().copied().map(Value::F64).collect())
}

/// Encodes a message, in either order of bytes.
pub fn encode(value: &Value, is_big_endian: bool) -> Vec<u8> {
    let mut bytes = Vec::new();
    write(value, is_big_endian, &mut bytes);
    [vec![0, u8::from(!is_big_endian), 0, 0], bytes].concat()
}

fn write(value: &Value, big: bool, out: &mut Vec<u8>) {
    match value {
        Value::Byte(byte) => out.push(*byte),
        Value::I32(number) => aligned(out, if big { number.to_be_bytes() } else { number.to_le_bytes() }),
        Value::U32(number) => aligned(out, if big { number.to_be_bytes() } else { number.to_le_bytes() }),
        Value::F64(number) => aligned(out, if big { number.to_be_bytes() } else { number.to_le_bytes() }),
        Value::Text(text) => {
            write(&Value::U32(text.len() as u32 + 1), big, out);
            out.extend(text.as_bytes());
            out.push(0);
        }
        Value::Bytes(bytes) => {
            write(&Value::U32(bytes.len() as u32), big, out);
            out.extend(bytes);
        }
        Value::Sequence(values) => {
            write(&Value::U32(values.len() as u32), big, out);
            values.iter().for_each(|value| write(value, big, out));
        }
        Value::All(values) => values.iter().for_each(|value| write(value, big, out)),
    }
}

fn aligned<const SIZE: usize>(out: &mut Vec<u8>, bytes: [u8; SIZE]) {
    while !out.len().is_multiple_of(SIZE) {
        out.push(0);
    }
    out.extend(bytes);
}
